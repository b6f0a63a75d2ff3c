// Photographs taken under different lights: who shines where.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace glint {

// Of one light, by view.
struct LightShows {
  std::vector<char> expected;  // the surface has a place that would mirror it to the camera
  std::vector<char> present;   // a highlight of it was found
};

struct LightGroups {
  int count = 1;
  std::vector<int> group_of_view;         // by view
  std::vector<std::vector<char>> shines;  // [group][light]
};

// Indices of the names in the order of the numbers in them: 9.jpg before 10.jpg, as photographs were taken.
std::vector<size_t> OrderByNumbers(const std::vector<std::string>& names);

// Splits the views, taken in the given order, into groups under different lights, where that describes what shows where
// shorter (minimum description length; every change from one view to the next costs, so that groups are runs of
// photographs). A light that is only missing somewhere makes no group, it may be hidden there: of two groups each must
// have a light that the other lacks.
LightGroups GroupViewsByLight(const std::vector<LightShows>& lights, const std::vector<size_t>& order);

// Of each group, the first and the last photograph of every run: "1.jpg to 4.jpg, 9.jpg".
std::vector<std::string> DescribeGroups(const LightGroups& groups, const std::vector<std::string>& names);

}  // namespace glint
