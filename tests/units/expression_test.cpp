#include "renderer/scene/expression.h"

#include <gtest/gtest.h>

#include <cmath>

using hoodoo::Expressions;

namespace
{

double value(const std::string& text)
{
    Expressions expressions;
    expressions.define("h", 2.5);
    expressions.define("frame", 12);
    const auto result = expressions.evaluate(text);
    EXPECT_EQ(result.problem, "") << text;
    return result.value;
}

Expressions::Result failure(const std::string& text)
{
    Expressions expressions;
    expressions.define("h", 2.5);
    return expressions.evaluate(text);
}

}  // namespace

TEST(Expression, arithmetic_has_the_usual_precedence)
{
    EXPECT_EQ(value("1 + 2 * 3"), 7.0);
    EXPECT_EQ(value("(1 + 2) * 3"), 9.0);
    EXPECT_EQ(value("2 ^ 3 ^ 2"), 512.0);  // right to left: 2^9
    EXPECT_EQ(value("-3 + 1"), -2.0);
    EXPECT_EQ(value("7 - 2 - 1"), 4.0);
    EXPECT_EQ(value("1e3 / 4"), 250.0);
    EXPECT_EQ(value("h > 2 ? 10 : 20"), 10.0);
}

TEST(Expression, names_and_functions_are_known)
{
    EXPECT_EQ(value("2 * h + frame"), 17.0);
    EXPECT_EQ(value("sin(pi / 2)"), 1.0);
    EXPECT_EQ(value("log(exp(1))"), 1.0);  // natural
    EXPECT_EQ(value("clamp(5, 0, 3)"), 3.0);
    EXPECT_EQ(value("mix(10, 20, 0.25)"), 12.5);
    EXPECT_EQ(value("max(1, h)"), 2.5);
    EXPECT_EQ(value("atan2(0, -1)"), std::acos(-1.0));
    EXPECT_EQ(value("degrees(radians(90))"), 90.0);
    EXPECT_EQ(value("round(2.4) + floor(2.9) + ceil(2.1)"), 7.0);
}

TEST(Expression, an_unknown_name_is_reported_with_its_place)
{
    const auto result = failure("2 * hh");
    EXPECT_EQ(result.problem, "unknown name in the expression");
    EXPECT_EQ(result.position, 4u);
    EXPECT_EQ(result.token, "hh");
}

TEST(Expression, what_has_no_finite_value_is_a_problem)
{
    for (const char* text : {"1 / 0", "sqrt(-1)", "log(0)", "10 ^ 400", "0 / 0"})
        EXPECT_EQ(failure(text).problem, "the expression's value is not finite") << text;
}

TEST(Expression, nothing_but_one_number_is_an_expression)
{
    for (const char* text : {"",          " ",   "1 +", "(1",       "1)",    "1, 2", "h = 3", "\"a\"", "sin()", "sin(1, 2)",
                             "system(1)", "1;2", "$",   "\xc3\xb6", "rnd()", "_pi",  "1 2",   "()",    "?:",    "sum(1)"})
        EXPECT_NE(failure(text).problem, "") << text;
}

TEST(Expression, length_is_bounded_before_it_is_read)
{
    const std::string sum = [] {
        std::string s = "0";
        while (s.size() + 2 <= Expressions::max_length) s += "+1";
        return s;
    }();
    EXPECT_EQ(value(sum), static_cast<double>(sum.size() / 2));
    EXPECT_EQ(failure(sum + "+1").problem, "the expression is too long");
    // The deepest nesting that fits.
    const std::string deep = std::string(511, '(') + "1" + std::string(511, ')');
    EXPECT_EQ(value(deep), 1.0);
    EXPECT_EQ(value("-(-(-1))"), -1.0);
}

TEST(Expression, an_evaluation_leaves_nothing_behind)
{
    Expressions expressions;
    expressions.define("a", 1);
    EXPECT_NE(expressions.evaluate("a = 5").problem, "");
    EXPECT_EQ(expressions.evaluate("a").value, 1.0);
    expressions.define("a", 2);
    EXPECT_EQ(expressions.evaluate("a").value, 2.0);
}

TEST(Expression, names_are_letters_digits_and_underscores_and_no_function)
{
    for (const char* good : {"a", "_a", "height_2", "Sin"}) EXPECT_TRUE(Expressions::valid_name(good)) << good;
    for (const char* bad : {"", "2a", "a-b", "a.b", "sin", "pi", "mix", "min", "a b", "\xc3\xb6"}) EXPECT_FALSE(Expressions::valid_name(bad)) << bad;
    EXPECT_FALSE(Expressions::valid_name(std::string(65, 'a')));
}
