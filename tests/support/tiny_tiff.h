// A TIFF made by hand, tag by tag: for what no library would write.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace hoodoo::testing
{

/// Little-endian TIFF of one strip of 16-bit samples, with any further tags.
class TinyTiff
{
public:
    TinyTiff(std::uint32_t width, std::uint32_t height, std::uint32_t stored) : stored_(stored)
    {
        tag(256, 4, 1, width), tag(257, 4, 1, height), tag(258, 3, 1, 16), tag(259, 3, 1, 1), tag(262, 3, 1, 1);
        tag(273, 4, 1, 8), tag(277, 3, 1, 1), tag(278, 4, 1, height), tag(279, 4, 1, stored * 2), tag(339, 3, 1, 2);
    }
    template <class T>
    void values(std::uint16_t id, std::uint16_t type, const std::vector<T>& data)
    {
        later_.push_back({tags_.size(), std::string(reinterpret_cast<const char*>(data.data()), data.size() * sizeof(T))});
        tag(id, type, static_cast<std::uint32_t>(data.size()), 0);
    }
    std::string bytes() const
    {
        std::string out = "II*";
        out.push_back('\0');
        const auto number = [&](std::uint32_t x, int size) { out.append(reinterpret_cast<const char*>(&x), static_cast<std::size_t>(size)); };
        number(8 + 2 * stored_, 4);
        for (std::uint32_t k = 0; k < stored_; ++k) number(k, 2);
        auto tags = tags_;
        std::uint32_t at = 8 + 2 * stored_ + 2 + 12 * static_cast<std::uint32_t>(tags.size()) + 4;
        for (const auto& [index, data] : later_) tags[index].value = at, at += static_cast<std::uint32_t>(data.size());
        number(static_cast<std::uint32_t>(tags.size()), 2);
        for (const Tag& t : tags) number(t.id, 2), number(t.type, 2), number(t.count, 4), number(t.value, 4);
        number(0, 4);
        for (const auto& [index, data] : later_) out += data;
        return out;
    }

private:
    struct Tag {
        std::uint16_t id, type;
        std::uint32_t count, value;
    };
    void tag(std::uint16_t id, std::uint16_t type, std::uint32_t count, std::uint32_t value) { tags_.push_back({id, type, count, value}); }
    std::uint32_t stored_;
    std::vector<Tag> tags_;
    std::vector<std::pair<std::size_t, std::string>> later_;
};

}  // namespace hoodoo::testing
