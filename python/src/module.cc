// The extension module glint._glint: Glint's stages over NumPy arrays. The package `glint` beside it is what people
// use.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>

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

py::dict RunProject(const RunArguments& arguments, const std::vector<std::string>& settings,
                    const py::object& callback) {
  const Config config = ConfigFrom(arguments.config, settings);
  const RunSummary summary =
      InBackground(callback, [&](Progress& progress) { return Run(arguments, config, progress); });
  py::dict d;
  d["model_path"] = summary.model;
  d["outcome"] = summary.outcome;
  return d;
}

}  // namespace

void BindRun(py::module_& m) {
  m.def(
      "run",
      [](const std::filesystem::path& project, const std::filesystem::path& out, const std::filesystem::path& config,
         const std::vector<std::string>& settings, const std::filesystem::path& lights,
         const std::filesystem::path& mesh, const std::filesystem::path& images, const std::filesystem::path& masks,
         const py::object& progress) {
        RunArguments arguments;
        arguments.project = project;
        arguments.out = out;
        arguments.config = config;
        arguments.lights = lights;
        arguments.mesh = mesh;
        arguments.images = images;
        arguments.masks = masks;
        arguments.command = "glint.run";
        return RunProject(arguments, settings, progress);
      },
      py::arg("project"), py::arg("out"), py::arg("config"), py::arg("settings"), py::arg("lights"), py::arg("mesh"),
      py::arg("images"), py::arg("masks"), py::arg("progress"));
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
