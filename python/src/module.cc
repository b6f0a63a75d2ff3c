// The extension module glint._glint: Glint's stages over NumPy arrays. The package `glint` beside it is what people
// use.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "background.h"
#include "bindings.h"
#include "core/error.h"
#include "core/parallel.h"
#include "pipeline/run.h"
#include "settings.h"

namespace glint::python {
namespace {

std::unique_ptr<ThreadLimit> thread_limit;

// Raises the class of glint._errors that goes with it.
void Raise(const char* name, const py::object& arguments) {
  const py::object type = py::module_::import("glint._errors").attr(name);
  PyErr_SetObject(type.ptr(), arguments.ptr());
}

void Translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputError& e) {
    Raise("InputError", py::make_tuple(e.what(), e.path(), e.record()));
  } catch (const NoResultError& e) {
    Raise("NoResultError", py::make_tuple(e.what()));
  } catch (const CancelledError& e) {
    Raise("CancelledError", py::make_tuple(e.what()));
  }
}

std::optional<RunStage> StageNamed(const std::string& name) {
  if (name.empty()) return std::nullopt;
  const auto found = std::find(kRunStageNames.begin(), kRunStageNames.end(), name);
  if (found == kRunStageNames.end())
    throw InputError("", "stage",
                     fmt::format("expected one of {}, found \"{}\"", fmt::join(kRunStageNames, ", "), name));
  return static_cast<RunStage>(found - kRunStageNames.begin());
}

// The paths that are not given are empty. Returns the outcome.
std::string RunProject(const py::dict& paths, const std::vector<std::string>& settings, const std::string& from,
                       const std::string& until, const py::object& callback) {
  const auto path = [&](const char* name) { return paths[name].cast<std::filesystem::path>(); };
  RunArguments arguments;
  arguments.project = path("project");
  arguments.out = path("out");
  arguments.config = path("config");
  arguments.lights = path("lights");
  arguments.mesh = path("mesh");
  arguments.images = path("images");
  arguments.masks = path("masks");
  arguments.normals = path("normals");
  arguments.stages = {StageNamed(from), StageNamed(until)};
  arguments.command = "glint.run";
  const Config config = ConfigFrom(arguments.config, settings);
  return InBackground(callback, [&](Progress& progress) { return Run(arguments, config, progress); }).outcome;
}

}  // namespace

void BindRun(py::module_& m) {
  m.def("run", &RunProject, py::arg("paths"), py::arg("settings"), py::arg("from_stage"), py::arg("until"),
        py::arg("progress"));
  m.def(
      "config_yaml",
      [](const std::filesystem::path& file, const std::vector<std::string>& settings) {
        return ConfigYaml(ConfigFrom(file, settings), "Resolved options.");
      },
      py::arg("file"), py::arg("settings"));
  m.def(
      "set_num_threads",
      [](int count) {
        thread_limit.reset();
        if (count > 0) thread_limit = std::make_unique<ThreadLimit>(count);
      },
      py::arg("count"));
}

}  // namespace glint::python

PYBIND11_MODULE(_glint, m) {
  namespace python = glint::python;
  m.attr("__version__") = GLINT_VERSION;
  pybind11::register_exception_translator(&python::Translate);
  python::BindMesh(m);
  python::BindLevelSet(m);
  python::BindProject(m);
  python::BindRun(m);
}
