// Memory in large pages where the system has them: rays go across a terrain, and a page of 4 kB holds little of it.
#pragma once

#include <cstddef>
#include <vector>

namespace hoodoo
{

/// Throws std::bad_alloc.
void* allocate_pages(std::size_t bytes);
void free_pages(void* pointer);

/// An allocator of the standard library's kind.
template <class T>
struct HugePages {
    using value_type = T;
    HugePages() = default;
    template <class U>
    HugePages(const HugePages<U>&)
    {
    }
    T* allocate(std::size_t count) { return static_cast<T*>(allocate_pages(count * sizeof(T))); }
    void deallocate(T* pointer, std::size_t) { free_pages(pointer); }
    friend bool operator==(const HugePages&, const HugePages&) { return true; }
};

}  // namespace hoodoo
