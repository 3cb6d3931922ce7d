// An error says where, what, what was expected, what was found, and the nearest valid name, then shows the line with a caret below the place.
// The distance between names is Damerau's, restricted (Damerau1964): insert, delete, replace, or swap two neighbours, each costs one.
// Deviation: a message shows at most 100 problems and 160 letters of anything quoted, so that a hostile file cannot fill a terminal.
#include "terrain/error.h"

#include <algorithm>
#include <cstddef>

namespace hoodoo
{
namespace
{

constexpr std::size_t shown_problems = 100;
constexpr std::size_t shown_letters = 160;
constexpr std::size_t longest_name = 64;  // longer ones have no typing errors, and the distance costs the product of the lengths

/// Control characters would reach the terminal: they become spaces. Cuts at a letter's border of UTF-8.
std::string printable(const std::string& text)
{
    std::string out = text.substr(0, shown_letters);
    if (text.size() > shown_letters) {
        while (!out.empty() && (static_cast<unsigned char>(text[out.size()]) & 0xc0) == 0x80) out.pop_back();
        out += "...";
    }
    for (char& c : out)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return out;
}

std::size_t letters(const std::string& text)
{
    return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::size_t edit_distance(const std::string& a, const std::string& b)
{
    std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0u : 1u)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
        }
        std::swap(before, last);
        std::swap(last, row);
    }
    return last[b.size()];
}

}  // namespace

std::string Problem::text() const
{
    std::string out;
    if (!where.file.empty()) out += printable(where.file) + ":";
    if (where.line > 0) out += std::to_string(where.line) + ":";
    if (where.line > 0 && where.column > 0) out += std::to_string(where.column) + ":";
    if (!out.empty()) out += " ";
    out += what;
    if (!expected.empty()) out += ", expected " + expected;
    if (!got.empty()) out += ", got " + printable(got);
    if (!nearest.empty()) out += " (did you mean \"" + nearest + "\")";

    // Show the line, and a caret below the place if it is inside what is shown.
    if (!where.excerpt.empty()) {
        const std::string line = printable(where.excerpt);
        out += "\n    " + line;
        if (where.column > 0 && static_cast<std::size_t>(where.column) <= letters(line) + 1)
            out += "\n    " + std::string(static_cast<std::size_t>(where.column) - 1, ' ') + "^";
    }
    return out;
}

Error::Error(ErrorKind kind, std::vector<Problem> problems) : kind_(kind), problems_(std::move(problems))
{
    for (std::size_t i = 0; i < problems_.size() && i < shown_problems; ++i) text_ += (i ? "\n" : "") + problems_[i].text();
    if (problems_.size() > shown_problems) text_ += "\nand " + std::to_string(problems_.size() - shown_problems) + " more problems";
}

std::string nearest_name(const std::string& name, const std::vector<std::string>& names)
{
    std::string best;
    if (name.size() > longest_name) return best;
    std::size_t smallest = static_cast<std::size_t>(-1);
    for (const std::string& candidate : names) {
        if (candidate.size() > longest_name) continue;
        const std::size_t d = edit_distance(name, candidate);
        if (d < smallest && 3 * d <= std::max(name.size(), candidate.size())) {
            smallest = d;
            best = candidate;
        }
    }
    return best;
}

}  // namespace hoodoo
