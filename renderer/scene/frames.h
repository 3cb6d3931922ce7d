// Frames of an animation: which ones are meant, and what their pictures are called.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hoodoo
{

/// "1-240", "1-10,20-50x2", "7": frames in the order given, repeats left out. N-MxS takes every S-th from N on; M < N counts down.
/// Throws Error (scene) that quotes the part which is none; at most 1e6 frames, each within +-1e9.
std::vector<std::int64_t> parse_frames(const std::string& text);

/// Whether `path` has a place for a frame: one run of #, or one %d, %04d.
bool names_frames(const std::string& path);

/// The path with the frame in its place, zero-padded to the length of the run ("wave.####.exr" -> "wave.0017.exr"). A path without a place comes back
/// as it is. Throws Error (scene) if there are two places.
std::string frame_path(const std::string& path, std::int64_t frame);

}  // namespace hoodoo
