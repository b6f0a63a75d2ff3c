// The parts of the extension module glint._glint, a file each.
#pragma once

#include <pybind11/pybind11.h>

namespace glint::python {

void BindMesh(pybind11::module_& m);
void BindLevelSet(pybind11::module_& m);
void BindProject(pybind11::module_& m);
void BindRun(pybind11::module_& m);

}  // namespace glint::python
