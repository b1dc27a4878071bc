// A bounded set of threads whose results do not depend on how many there are.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <thread>
#include <utility>
#include <vector>

namespace pllit {

/// Runs loops on at most `threads` threads. Work is cut into chunks of fixed size and combined in chunk order, so sums
/// of floating-point numbers come out the same to the bit for any number of threads.
class Arena {
 public:
  /// Zero or fewer threads: one for each of the machine's.
  explicit Arena(int threads)
      : arena_(threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))) {}

  /// Calls body(begin, end) for chunks of [0, count).
  template <class Body>
  void for_chunks(std::size_t count, std::size_t chunk, const Body& body) {
    const std::size_t chunks = (count + chunk - 1) / chunk;
    arena_.execute([&] {
      tbb::parallel_for(std::size_t{0}, chunks,
                        [&](std::size_t i) { body(i * chunk, std::min(count, (i + 1) * chunk)); });
    });
  }

  /// Sums body(begin, end) over chunks of [0, count), in chunk order. Sum needs operator+=.
  template <class Sum, class Body>
  Sum sum_chunks(std::size_t count, std::size_t chunk, Sum zero, const Body& body) {
    std::vector<Sum> parts((count + chunk - 1) / chunk, zero);
    for_chunks(count, chunk, [&](std::size_t begin, std::size_t end) { parts[begin / chunk] = body(begin, end); });
    Sum sum = std::move(zero);
    for (const Sum& part : parts) sum += part;
    return sum;
  }

 private:
  tbb::task_arena arena_;
};

}  // namespace pllit
