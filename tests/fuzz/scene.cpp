// libFuzzer harness of the scene reader: any bytes give a Description or an Error, within the limits, and nothing else.
// The text may include files of the current folder only; run it in an empty one.
#include "renderer/scene/read.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const std::string text(reinterpret_cast<const char*>(data), size);
    try {
        const hoodoo::Description scene = hoodoo::read_scene(text, true);
        // What was accepted is accepted again, and is the same scene.
        if (hoodoo::read_scene(text, true).hash != scene.hash) std::abort();
    } catch (const hoodoo::Error& error) {
        if (error.kind() == hoodoo::ErrorKind::internal || error.problems().empty()) std::abort();
    }
    return 0;
}
