// Large pages by advice to the kernel (Linux's transparent huge pages, 2 MB): fewer misses of the address cache when rays cross a large grid.
#include "terrain/math/pages.h"

#include <cstdlib>
#include <new>
#include <sys/mman.h>

namespace hoodoo
{

void* allocate_pages(std::size_t bytes)
{
    constexpr std::size_t huge = std::size_t{1} << 21;
    // Small grids are not worth a large page.
    const std::size_t page = bytes >= huge ? huge : 64;
    void* memory = std::aligned_alloc(page, (bytes + page - 1) / page * page);
    if (!memory) throw std::bad_alloc();
    if (page == huge) ::madvise(memory, (bytes + page - 1) / page * page, MADV_HUGEPAGE);  // advice: without it all works, slower
    return memory;
}

void free_pages(void* pointer)
{
    std::free(pointer);
}

}  // namespace hoodoo
