// TOML text -> Node: toml++ parses, this file guards it and keeps every position. The only includer of toml++.
// A scan of the raw text refuses what would cost too much to parse or to free: NUL bytes, nesting (of brackets and of dotted keys, which toml++ turns
// into tables that are destroyed recursively) and the number of values. It knows strings and comments, nothing else of TOML.
// Missing: of several syntax errors only the first is reported, since what follows one means nothing. Dates are refused: no parameter is one.
#include "renderer/scene/toml_text.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

namespace hoodoo
{
namespace
{

constexpr std::size_t kept_line = 160;  // letters of a line that an error can show; 1e5 values then keep at most 32 MB of them

std::vector<std::string_view> split_lines(const std::string& text)
{
    std::vector<std::string_view> lines;
    std::size_t begin = 0;
    while (begin <= text.size()) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        lines.push_back(std::string_view(text).substr(begin, end - begin));
        begin = end + 1;
    }
    return lines;
}

Source place(const std::string& file, const std::vector<std::string_view>& lines, std::size_t line, std::size_t column)
{
    Source where{file, static_cast<int>(line), static_cast<int>(column), {}};
    if (line >= 1 && line <= lines.size()) {
        where.excerpt = std::string(lines[line - 1].substr(0, kept_line));
        if (!where.excerpt.empty() && where.excerpt.back() == '\r') where.excerpt.pop_back();
    }
    return where;
}

/// Reads raw text as far as limits need it. scan() returns what is wrong, or "", and leaves the position there.
class LimitScan
{
public:
    LimitScan(const std::string& text, std::size_t node_limit) : text_(text), token_limit_(4 * node_limit) {}

    std::string scan()
    {
        for (at_ = 0; at_ < text_.size(); ++at_) {
            const char c = text_[at_];
            if (c == '"' || c == '\'')
                skip_string(c);
            else if (c == '#')
                at_ = std::min(text_.find('\n', at_), text_.size()) - 1;
            else if (const char* problem = structure(c))
                return problem;
        }
        return {};
    }

    std::size_t position() const { return std::min(at_, text_.size()); }

private:
    const char* structure(char c)
    {
        if (c == '[' || c == '{') ++depth_;
        if ((c == ']' || c == '}') && depth_ > 0) --depth_;
        if (c == '.') ++dots_;
        if (c == '=' || c == ',' || c == '\n' || c == '[' || c == '{') dots_ = 0;
        tokens_ += c == '=' || c == ',' || c == '[' || c == '.';
        if (depth_ > max_nesting || dots_ >= max_nesting) return "lists and tables are nested too deeply";
        return tokens_ > token_limit_ ? "the file has too many values" : nullptr;
    }

    /// Ends at the last quote. A text on one line ends with the line: the parser says why it is wrong.
    void skip_string(char quote)
    {
        const std::string three(3, quote);
        const bool block = text_.compare(at_, 3, three) == 0;
        at_ += block ? 3 : 1;
        for (; at_ < text_.size(); ++at_) {
            if (text_[at_] == '\\' && quote == '"')
                ++at_;
            else if (block ? text_.compare(at_, 3, three) == 0 : text_[at_] == quote)
                break;
            else if (!block && text_[at_] == '\n')
                return;
        }
        if (block) at_ += 2;
    }

    const std::string& text_;
    std::size_t token_limit_;
    std::size_t at_ = 0, tokens_ = 0;
    int depth_ = 0, dots_ = 0;
};

/// toml++'s tree -> ours, in the order of the file.
class Converter
{
public:
    Converter(const std::string& file, const std::vector<std::string_view>& lines, SceneBudget& budget, std::vector<Problem>& problems)
        : file_(file), lines_(lines), budget_(budget), problems_(problems)
    {
    }

    Node convert(const toml::node& node, int depth)
    {
        Node out;
        out.where = at(node.source().begin);
        out.key_where = out.where;
        if (depth > max_nesting)
            complain_once(out.where, "lists and tables are nested too deeply", fmt::format("at most {} levels", max_nesting));
        else if (!budget_.take(0, 1))
            complain_once(out.where, "the scene has too many values", "at most 100000");
        else if (const auto* table = node.as_table())
            out.value = convert_table(*table, depth);
        else if (const auto* array = node.as_array()) {
            Node::Array items;
            for (const toml::node& item : *array) items.push_back(convert(item, depth + 1));
            out.value = std::move(items);
        } else
            convert_scalar(node, out);
        return out;
    }

private:
    Source at(const toml::source_position& p) const { return place(file_, lines_, p.line, p.column); }

    void complain(const Source& where, std::string what, std::string expected, std::string got = {})
    {
        problems_.push_back({where, std::move(what), std::move(expected), std::move(got), {}});
    }

    /// Of a limit that every further value breaks too.
    void complain_once(const Source& where, const std::string& what, std::string expected)
    {
        if (problems_.empty() || problems_.back().what != what) complain(where, what, std::move(expected));
    }

    Node::Table convert_table(const toml::table& table, int depth)
    {
        std::vector<std::pair<const toml::key*, const toml::node*>> entries;
        for (const auto& [key, value] : table) entries.emplace_back(&key, &value);
        const auto place_of = [](const toml::key* key) { return std::pair(key->source().begin.line, key->source().begin.column); };
        std::sort(entries.begin(), entries.end(), [&](const auto& a, const auto& b) { return place_of(a.first) < place_of(b.first); });
        Node::Table out;
        for (const auto& [key, value] : entries) {
            Node node = convert(*value, depth + 1);
            node.key_where = at(key->source().begin);
            out.emplace_back(std::string(key->str()), std::move(node));
        }
        return out;
    }

    void convert_scalar(const toml::node& node, Node& out)
    {
        if (const auto* b = node.as_boolean())
            out.value = b->get();
        else if (const auto* i = node.as_integer())
            out.value = i->get();
        else if (const auto* s = node.as_string())
            out.value = s->get();
        else if (const auto* x = node.as_floating_point()) {
            if (std::isfinite(x->get()))
                out.value = x->get();
            else
                complain(out.where, "a number is not finite", "a finite number", fmt::format("{}", x->get()));
        } else
            complain(out.where, "dates and times have no meaning in a scene", "a number, a text, a list or a table", {});
    }

    const std::string& file_;
    const std::vector<std::string_view>& lines_;
    SceneBudget& budget_;
    std::vector<Problem>& problems_;
};

Source place_of_offset(const std::string& text, std::size_t offset, const std::string& file, const std::vector<std::string_view>& lines)
{
    const auto begin = text.begin(), end = begin + static_cast<std::ptrdiff_t>(offset);
    const auto line = static_cast<std::size_t>(std::count(begin, end, '\n'));
    const std::size_t line_start = line ? text.rfind('\n', offset - 1) + 1 : 0;
    // Columns count letters, not bytes: continuation bytes of UTF-8 are none.
    const auto column =
        std::count_if(begin + static_cast<std::ptrdiff_t>(line_start), end, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; });
    return place(file, lines, line + 1, static_cast<std::size_t>(column) + 1);
}

}  // namespace

bool SceneBudget::take(std::size_t byte_count, std::size_t node_count)
{
    const bool enough = byte_count <= bytes && node_count <= nodes;
    bytes -= std::min(bytes, byte_count);
    nodes -= std::min(nodes, node_count);
    return enough;
}

Node parse_toml(const std::string& text, const std::string& file, SceneBudget& budget, std::vector<Problem>& problems)
{
    const Source start{file, 1, 1, {}};
    if (!budget.take(text.size(), 0)) {
        problems.push_back({start, "the scene is too long", "at most 64 MB with its includes", {}, {}});
        return {};
    }
    const auto lines = split_lines(text);
    if (const auto nul = text.find('\0'); nul != std::string::npos) {
        problems.push_back({place_of_offset(text, nul, file, lines), "the file holds a NUL byte", "a text file (TOML 1.0)", {}, {}});
        return {};
    }
    LimitScan scan(text, budget.nodes);
    if (const std::string what = scan.scan(); !what.empty()) {
        const std::string limits = fmt::format("at most {} levels and 100000 values", max_nesting);
        problems.push_back({place_of_offset(text, scan.position(), file, lines), what, limits, {}, {}});
        return {};
    }
    try {
        const toml::table table = toml::parse(text);
        Node root = Converter(file, lines, budget, problems).convert(table, 0);
        root.where = root.key_where = start;
        return root;
    } catch (const toml::parse_error& error) {
        const auto& p = error.source().begin;
        problems.push_back({place(file, lines, p.line, p.column), std::string(error.description()), {}, {}, {}});
        return {};
    }
}

Node parse_toml_value(const std::string& text, const Source& where)
{
    const auto stand_at = [&](Node node) {
        const auto visit = [&](const auto& self, Node& n) -> void {
            n.where = n.key_where = where;
            if (auto* items = std::get_if<Node::Array>(&n.value))
                for (Node& item : *items) self(self, item);
            if (auto* table = std::get_if<Node::Table>(&n.value))
                for (auto& entry : *table) self(self, entry.second);
        };
        visit(visit, node);
        return node;
    };
    SceneBudget budget;
    std::vector<Problem> problems;
    Node parsed = parse_toml("value = " + text, where.file, budget, problems);
    // A line break could smuggle in more keys: then it is a text too.
    auto* table = std::get_if<Node::Table>(&parsed.value);
    if (problems.empty() && table && table->size() == 1) return stand_at(std::move(table->front().second));
    Node node;
    node.value = text;
    return stand_at(std::move(node));
}

}  // namespace hoodoo
