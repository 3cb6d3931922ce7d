// Frame ranges as farm managers write them, and numbered names as compositors read them: a run of # or printf's %0Nd.
#include "renderer/scene/frames.h"

#include "terrain/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <unordered_set>

namespace hoodoo
{
namespace
{

constexpr std::int64_t most_frames = 1000000, farthest = 1000000000;

[[noreturn]] void refuse(const std::string& part)
{
    throw Error(ErrorKind::scene,
                Problem{{}, "this is no range of frames", "N, N-M or N-MxS with commas between, such as 1-10,20-50x2", "\"" + part + "\"", {}});
}

/// Reads a whole number off the front of `text`.
std::optional<std::int64_t> take_number(std::string_view& text)
{
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || std::abs(value) > farthest) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return value;
}

struct Range {
    std::int64_t first, last, step;
};

Range parse_range(const std::string& part)
{
    std::string_view rest = part;
    const auto first = take_number(rest);
    if (!first) refuse(part);
    Range range{*first, *first, 1};
    if (rest.empty()) return range;
    if (rest.front() != '-') refuse(part);
    rest.remove_prefix(1);
    const auto last = take_number(rest);
    if (!last) refuse(part);
    range.last = *last;
    if (rest.empty()) return range;
    if (rest.front() != 'x') refuse(part);
    rest.remove_prefix(1);
    const auto step = take_number(rest);
    if (!step || *step < 1 || !rest.empty()) refuse(part);
    range.step = *step;
    return range;
}

/// Where a frame goes in a path: [begin, end), and how many digits it has at least.
struct Place {
    std::size_t begin, end;
    int digits;
};

std::vector<Place> places(const std::string& path)
{
    std::vector<Place> found;
    for (std::size_t i = 0; i < path.size(); ++i) {
        if (path[i] == '#') {
            const std::size_t end = std::min(path.find_first_not_of('#', i), path.size());
            found.push_back({i, end, static_cast<int>(end - i)});
            i = end - 1;
        } else if (path[i] == '%') {
            const std::size_t end = path.find_first_not_of("0123456789", i + 1);
            if (end == std::string::npos || path[end] != 'd' || end - i > 3) continue;
            found.push_back({i, end + 1, end > i + 1 ? std::stoi(path.substr(i + 1, end - i - 1)) : 1});
            i = end;
        }
    }
    return found;
}

}  // namespace

std::vector<std::int64_t> parse_frames(const std::string& text)
{
    std::vector<std::int64_t> frames;
    std::unordered_set<std::int64_t> seen;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t comma = std::min(text.find(',', begin), text.size());
        const Range range = parse_range(text.substr(begin, comma - begin));
        const std::int64_t count = std::abs(range.last - range.first) / range.step + 1;
        if (count + static_cast<std::int64_t>(frames.size()) > most_frames)
            throw Error(ErrorKind::scene, Problem{{}, "these are too many frames", fmt::format("at most {}", most_frames), "\"" + text + "\"", {}});
        for (std::int64_t k = 0; k < count; ++k) {
            const std::int64_t frame = range.first + (range.last < range.first ? -k : k) * range.step;
            if (seen.insert(frame).second) frames.push_back(frame);
        }
        begin = comma + 1;
    }
    return frames;
}

bool names_frames(const std::string& path)
{
    return !places(path).empty();
}

std::string frame_path(const std::string& path, std::int64_t frame)
{
    const std::vector<Place> found = places(path);
    if (found.empty()) return path;
    if (found.size() > 1)
        throw Error(ErrorKind::scene, Problem{{}, "a name has two places for the frame", "one run of # or one %04d", "\"" + path + "\"", {}});
    const Place& place = found.front();
    const std::string sign = frame < 0 ? "-" : "";
    return path.substr(0, place.begin) + sign + fmt::format("{:0{}}", std::abs(frame), place.digits) + path.substr(place.end);
}

}  // namespace hoodoo
