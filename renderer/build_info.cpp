// What this program is made of. The versions come from the build, which found the libraries: no header of theirs is needed here.
#include "renderer/build_info.h"

#include <array>
#include <cpuid.h>
#include <cstring>

namespace hoodoo
{

std::string version()
{
    return HOODOO_VERSION;
}

std::string baseline_name()
{
    return HOODOO_BASELINE;
}

std::vector<std::pair<std::string, std::string>> library_versions()
{
    // "Embree 3.13.5;OpenEXR 3.1.5;..."
    std::vector<std::pair<std::string, std::string>> out;
    const std::string list = HOODOO_LIBRARIES;
    for (std::size_t begin = 0; begin < list.size();) {
        const std::size_t end = std::min(list.find(';', begin), list.size());
        const std::string item = list.substr(begin, end - begin);
        const std::size_t space = item.find(' ');
        out.emplace_back(item.substr(0, space), item.substr(space + 1));
        begin = end + 1;
    }
    return out;
}

std::string processor_name()
{
    // The brand string: 48 letters in three leaves.
    std::array<unsigned, 12> words{};
    for (unsigned k = 0; k < 3; ++k)
        if (!__get_cpuid(0x80000002u + k, &words[4 * k], &words[4 * k + 1], &words[4 * k + 2], &words[4 * k + 3])) return "unknown";
    std::array<char, 49> letters{};
    std::memcpy(letters.data(), words.data(), 48);
    const std::string name = letters.data();
    const std::size_t first = name.find_first_not_of(' ');
    return first == std::string::npos ? "unknown" : name.substr(first, name.find_last_not_of(' ') - first + 1);
}

}  // namespace hoodoo
