// A loop over independent items by all threads there are. Beginning and end are told to the memory model by an atomic of ours too, because a
// sanitizer cannot see the ones inside TBB; items are coarse, so that costs nothing.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cstddef>

namespace hoodoo
{

/// Calls body(i) once for each i in [0, count), in any order, in the current TBB arena; an item is never split nor joined with another. Returns when
/// all are done; what a body throws comes through, and the rest may then be left out.
template <class Index, class Body>
void parallel_items(Index count, Body&& body)
{
    std::atomic<std::size_t> done{0};
    done.store(0, std::memory_order_release);
    tbb::parallel_for(
        tbb::blocked_range<Index>(0, count, 1),
        [&](const tbb::blocked_range<Index>& range) {
            done.load(std::memory_order_acquire);
            for (Index i = range.begin(); i < range.end(); ++i) body(i);
            done.fetch_add(1, std::memory_order_acq_rel);
        },
        tbb::simple_partitioner());
    done.load(std::memory_order_acquire);
}

}  // namespace hoodoo
