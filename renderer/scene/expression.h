// Arithmetic in scenes: "= 2 * height + 0.3". Bounded, pure, no names but the given ones.
#pragma once

#include <memory>
#include <string>

namespace hoodoo
{

/// Evaluates expressions over named constants. Not thread-safe; one for each scene that is read.
class Expressions
{
public:
    static constexpr std::size_t max_length = 1024;  ///< letters of one expression

    struct Result {
        double value = 0.0;
        std::string problem;       ///< empty if all is well
        std::size_t position = 0;  ///< of the problem, from the expression's first letter
        std::string token;         ///< the unknown name, if that is the problem
    };

    Expressions();
    ~Expressions();
    Expressions(const Expressions&) = delete;
    Expressions& operator=(const Expressions&) = delete;

    /// Names are letters, digits and underscores, no digit first, and none of the functions below or pi.
    static bool valid_name(const std::string& name);
    void define(const std::string& name, double value);

    /// `text` without the leading "=". Operators + - * / ^, comparisons, && || and a ? b : c; functions sin cos tan asin acos atan atan2 exp log
    /// (natural) log10 log2 sqrt abs floor ceil round min max clamp mix radians degrees; pi; the defined names. A result that is not finite is a
    /// problem.
    Result evaluate(const std::string& text) const;

private:
    struct Parser;
    std::unique_ptr<Parser> parser_;
};

}  // namespace hoodoo
