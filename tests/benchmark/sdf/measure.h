// Time and memory of one piece of work.
#pragma once

#include <malloc.h>
#include <time.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace glint::benchmark {

inline double Seconds(clockid_t clock) {
  timespec t;
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// A line of /proc/self/status, in bytes.
inline double StatusBytes(const std::string& wanted) {
  std::ifstream in("/proc/self/status");
  for (std::string key; in >> key;) {
    double kilobytes;
    if (key == wanted + ":" && in >> kilobytes) return 1024 * kilobytes;
  }
  return 0;
}

struct Cost {
  double wall_s = 0, cpu_s = 0;
  double peak_bytes = 0;  // beyond what was in use before
};

// The fastest of up to `repeats` runs; fewer where they take long. `clean_up` follows each run and is not measured.
template <class Work, class CleanUp>
Cost Measure(int repeats, const Work& work, const CleanUp& clean_up) {
  Cost best{1e300, 1e300, 0};
  double spent = 0;
  for (int i = 0; i < repeats && (i == 0 || spent < 4); ++i) {
    if (i > 0) clean_up();
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << "5";  // the peak starts anew
    const double before = StatusBytes("VmRSS"), wall = Seconds(CLOCK_MONOTONIC),
                 cpu = Seconds(CLOCK_PROCESS_CPUTIME_ID);
    work();
    const double cpu_s = Seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu, wall_s = Seconds(CLOCK_MONOTONIC) - wall;
    best.peak_bytes = std::max(best.peak_bytes, StatusBytes("VmHWM") - before);
    best.cpu_s = std::min(best.cpu_s, cpu_s);
    best.wall_s = std::min(best.wall_s, wall_s);
    spent += wall_s;
  }
  return best;
}

}  // namespace glint::benchmark
