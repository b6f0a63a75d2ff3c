// What no method can do without, and the memory that Glint takes.
#pragma once

namespace glint::benchmark {

// What the same leaves cost without any distances, and the kernel without the rest; bytes a voxel and a triangle.
void PrintFloor();

}  // namespace glint::benchmark
