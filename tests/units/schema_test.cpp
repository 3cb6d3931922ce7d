#include "terrain/schema.h"
#include "terrain/schema_values.h"

#include <gtest/gtest.h>

#include <numbers>

using namespace hoodoo;
using T = ParameterType;

namespace
{

Node value(auto v, int column = 1)
{
    Node node;
    node.value = std::move(v);
    node.where = {"test.toml", 1, column, {}};
    node.key_where = node.where;
    return node;
}

Node text(const char* s)
{
    return value(std::string(s));
}
Node whole(std::int64_t i)
{
    return value(i);
}

Node table(Node::Table entries)
{
    return value(std::move(entries));
}

Node list(std::initializer_list<double> numbers)
{
    Node::Array items;
    for (const double x : numbers) items.push_back(value(x));
    return value(std::move(items));
}

/// A schema of the one parameter `x`, checked against the one value.
struct Checked {
    Values values;
    std::vector<Problem> problems;
};

Checked check_one(Parameter p, Node node, const std::string& key = "x")
{
    p.name = "x";
    Checked out;
    out.values = check(Schema{"thing", "", {p}}, table({{key, std::move(node)}}), out.problems);
    return out;
}

std::string problem_of(Parameter p, Node node, const std::string& key = "x")
{
    const Checked c = check_one(std::move(p), std::move(node), key);
    return c.problems.size() == 1 ? c.problems[0].text() : std::to_string(c.problems.size()) + " problems";
}

double number_of(Parameter p, Node node, const std::string& key = "x")
{
    const Checked c = check_one(std::move(p), std::move(node), key);
    EXPECT_TRUE(c.problems.empty()) << c.problems[0].text();
    return c.problems.empty() ? c.values.number("x") : NAN;
}

}  // namespace

TEST(Quantity, units_are_converted_to_metres_radians_and_seconds)
{
    EXPECT_EQ(parse_quantity("350 m", T::length), 350.0);
    EXPECT_EQ(parse_quantity("1.2 km", T::length), 1200.0);
    EXPECT_EQ(parse_quantity("5mm", T::length), 0.005);
    EXPECT_EQ(parse_quantity("-2.5e1 cm", T::length), -0.25);
    EXPECT_EQ(parse_quantity("90 deg", T::angle), std::numbers::pi / 2);
    EXPECT_EQ(parse_quantity("45 deg", T::angle), std::numbers::pi / 4);
    EXPECT_EQ(parse_quantity("0.2 rad", T::angle), 0.2);
    EXPECT_EQ(parse_quantity("40 ms", T::duration), 0.04);
    EXPECT_EQ(parse_quantity("2 h", T::duration), 7200.0);
}

TEST(Quantity, what_is_no_number_with_a_unit_of_the_kind_is_nothing)
{
    for (const char* bad :
         {"", "m", "3", "3 ", "3 deg", "3 M", "3 m m", "0x3 m", "nan m", "inf m", "1e999 m", "1e306 km", "3,5 m", " 3 m", "3 m\n", "+3 m"})
        EXPECT_FALSE(parse_quantity(bad, T::length)) << bad;
    EXPECT_FALSE(parse_quantity("12 m", T::angle));
    EXPECT_FALSE(parse_quantity("12 m", T::duration));
}

TEST(Schema, a_length_is_bare_metres_or_a_text_with_a_unit)
{
    EXPECT_EQ(number_of({.type = T::length}, whole(350)), 350.0);
    EXPECT_EQ(number_of({.type = T::length}, value(1.5)), 1.5);
    EXPECT_EQ(number_of({.type = T::length}, text("1.5 m")), 1.5);
    EXPECT_EQ(problem_of({.type = T::length}, text("1.5 deg")),
              "test.toml:1:1: x cannot be read, expected a length such as 350 (metres) or \"350 m\", got \"1.5 deg\"");
}

TEST(Schema, a_bare_number_for_an_angle_is_an_error_unless_the_key_says_degrees)
{
    EXPECT_EQ(problem_of({.type = T::angle}, whole(40)),
              "test.toml:1:1: x is an angle without a unit, expected an angle such as \"12 deg\" (or the key x_deg with a number), got 40");
    EXPECT_EQ(number_of({.type = T::angle}, whole(90), "x_deg"), std::numbers::pi / 2);
    EXPECT_EQ(number_of({.type = T::angle}, text("90 deg")), std::numbers::pi / 2);
    EXPECT_EQ(problem_of({.type = T::angle}, text("90 deg"), "x_deg"),
              "test.toml:1:1: x_deg has the wrong type, expected an angle such as \"12 deg\" (or the key x_deg with a number), got \"90 deg\"");
}

TEST(Schema, an_angle_given_under_both_keys_is_an_error)
{
    std::vector<Problem> problems;
    check(Schema{"sun", "", {{.name = "elevation", .type = T::angle}}}, table({{"elevation", text("1 deg")}, {"elevation_deg", whole(1)}}), problems);
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_EQ(problems[0].text(), "test.toml:1:1: elevation is given twice, expected one of elevation and elevation_deg");
}

TEST(Schema, ranges_are_checked_at_both_ends)
{
    const Parameter share{.type = T::number, .minimum = 0, .maximum = 1};
    EXPECT_EQ(number_of(share, value(0.0)), 0.0);
    EXPECT_EQ(number_of(share, value(1.0)), 1.0);
    EXPECT_EQ(problem_of(share, value(1.5)), "test.toml:1:1: x is out of range, expected a number between 0 and 1, got 1.5");
    EXPECT_EQ(problem_of(share, value(-0.25)), "test.toml:1:1: x is out of range, expected a number between 0 and 1, got -0.25");
    const Parameter above{.type = T::number, .minimum = 0, .above_minimum = true};
    EXPECT_EQ(problem_of(above, value(0.0)), "test.toml:1:1: x is out of range, expected a number above 0, got 0");
    EXPECT_EQ(
        problem_of({.type = T::angle, .minimum = 0, .maximum = std::numbers::pi / 2}, whole(91), "x_deg"),
        "test.toml:1:1: x is out of range, expected an angle such as \"12 deg\" (or the key x_deg with a number) between 0 deg and 90 deg, got 91");
}

TEST(Schema, a_number_is_finite_whoever_made_the_table)
{
    EXPECT_EQ(problem_of({.type = T::number}, value(NAN)), "test.toml:1:1: x has the wrong type, expected a number, got nan");
    EXPECT_EQ(problem_of({.type = T::length}, value(kInfinity)),
              "test.toml:1:1: x has the wrong type, expected a length such as 350 (metres) or \"350 m\", got inf");
}

TEST(Schema, an_integer_may_be_an_integral_real_and_nothing_else)
{
    EXPECT_EQ(check_one({.type = T::integer}, value(1e3)).values.integer("x"), 1000);
    EXPECT_EQ(check_one({.type = T::integer}, whole(-7)).values.integer("x"), -7);
    EXPECT_EQ(problem_of({.type = T::integer, .minimum = 1}, value(2.5)),
              "test.toml:1:1: x has the wrong type, expected an integer of at least 1, got 2.5");
    EXPECT_EQ(problem_of({.type = T::integer}, value(1e300)), "test.toml:1:1: x has the wrong type, expected an integer, got 1e+300");
    EXPECT_EQ(problem_of({.type = T::integer}, text("3")), "test.toml:1:1: x has the wrong type, expected an integer, got \"3\"");
}

TEST(Schema, a_choice_names_what_there_is_and_the_nearest)
{
    const Parameter p{.type = T::choice, .choices = {"exact", "sphere"}};
    EXPECT_EQ(check_one(p, text("exact")).values.text("x"), "exact");
    EXPECT_EQ(problem_of(p, text("spheer")),
              "test.toml:1:1: x has an unknown value, expected one of \"exact\", \"sphere\", got \"spheer\" (did you mean \"sphere\")");
}

TEST(Schema, vectors_count_their_numbers_and_may_be_lengths)
{
    const Parameter p{.type = T::vector, .unit = "m", .min_count = 3, .max_count = 3};
    const Checked c = check_one(p, value(Node::Array{whole(1), text("2 km"), value(0.5)}));
    ASSERT_TRUE(c.problems.empty());
    EXPECT_EQ(c.values.vec3("x"), Vec3d(1, 2000, 0.5));
    EXPECT_EQ(problem_of(p, list({1, 2})), "test.toml:1:1: x has the wrong length, expected a list of 3 lengths, got a list of 2 values");
    EXPECT_EQ(problem_of({.type = T::vector, .min_count = 2, .max_count = 2}, value(Node::Array{whole(1), text("2 km")})),
              "test.toml:1:1: x cannot be read, expected a list of 2 numbers, got \"2 km\"");
}

TEST(Schema, points_are_lists_of_three)
{
    const Checked c = check_one({.type = T::points, .min_count = 2}, value(Node::Array{list({1, 2, 3}), list({4, 5, 6})}));
    ASSERT_TRUE(c.problems.empty());
    EXPECT_EQ(c.values.points("x")[1], Vec3d(4, 5, 6));
    EXPECT_FALSE(check_one({.type = T::points}, value(Node::Array{list({1, 2})})).problems.empty());
    EXPECT_FALSE(check_one({.type = T::points, .min_count = 2}, value(Node::Array{list({1, 2, 3})})).problems.empty());
}

TEST(Schema, a_colour_names_its_space)
{
    const Parameter p{.type = T::color, .minimum = 0, .maximum = 1};
    const auto color = [&](Node node) { return check_one(p, std::move(node)).values.color("x"); };
    EXPECT_EQ(color(text("#ff8000")).space, "srgb");
    EXPECT_EQ(color(text("#ff8000")).rgb, Vec3d(1.0, 128.0 / 255.0, 0.0));
    EXPECT_EQ(color(table({{"lin_rec709", list({0.1, 0.2, 0.3})}})).space, "lin_rec709");
    EXPECT_EQ(color(table({{"acescg", list({0.1, 0.2, 0.3})}})).rgb, Vec3d(0.1, 0.2, 0.3));
    EXPECT_EQ(color(table({{"grey", value(0.5)}})).rgb, Vec3d(0.5));
    EXPECT_FALSE(check_one(p, list({0.1, 0.2, 0.3})).problems.empty()) << "a colour without a space";
    EXPECT_FALSE(check_one(p, text("#ff80")).problems.empty());
    EXPECT_FALSE(check_one(p, text("#ff80g0")).problems.empty());
    EXPECT_FALSE(check_one(p, table({{"grey", value(1.5)}})).problems.empty());
    EXPECT_FALSE(check_one(p, table({{"srgb", list({1, 1, 1})}, {"grey", value(0.5)}})).problems.empty()) << "two spaces";
    const Checked wrong = check_one(p, table({{"sgrb", list({1, 1, 1})}}));
    ASSERT_EQ(wrong.problems.size(), 1u);
    EXPECT_EQ(wrong.problems[0].nearest, "srgb");
}

TEST(Schema, unknown_keys_and_missing_ones_are_all_reported)
{
    const Schema schema{
        "camera",
        "",
        {{.name = "eye", .type = T::vector, .required = true, .min_count = 3, .max_count = 3}, {.name = "up", .type = T::text, .required = true}}};
    std::vector<Problem> problems;
    check(schema, table({{"eyee", list({1, 2, 3})}, {"colour", whole(3)}}), problems);
    ASSERT_EQ(problems.size(), 4u);
    EXPECT_EQ(problems[0].text(), "test.toml:1:1: unknown key \"eyee\" in camera (did you mean \"eye\")");
    EXPECT_EQ(problems[1].text(), "test.toml:1:1: unknown key \"colour\" in camera");
    EXPECT_EQ(problems[2].text(), "test.toml:1:1: camera lacks the key \"eye\", expected a list of 3 numbers");
    EXPECT_EQ(problems[3].text(), "test.toml:1:1: camera lacks the key \"up\", expected a text");
}

TEST(Schema, a_value_that_already_has_its_problem_gets_no_second_one)
{
    Node broken = text("= 2 *");
    broken.broken = true;
    EXPECT_TRUE(check_one({.type = T::integer}, broken).problems.empty());
}

TEST(Schema, defaults_are_used_in_the_type_of_the_parameter)
{
    std::vector<Problem> problems;
    const Schema schema{"thing",
                        "",
                        {{.name = "n", .type = T::number, .fallback = std::int64_t{3}},
                         {.name = "i", .type = T::integer, .fallback = std::int64_t{3}},
                         {.name = "p", .type = T::points, .fallback = std::vector<double>{1, 2, 3, 4, 5, 6}},
                         {.name = "none", .type = T::number}}};
    const Values values = check(schema, table({}), problems);
    EXPECT_TRUE(problems.empty());
    EXPECT_EQ(values.number("n"), 3.0);
    EXPECT_EQ(values.integer("i"), 3);
    EXPECT_EQ(values.points("p")[1], Vec3d(4, 5, 6));
    EXPECT_FALSE(values.has("none"));
}

TEST(Schema, a_getter_used_wrongly_is_an_internal_error_not_the_users)
{
    std::vector<Problem> problems;
    const Values values = check(Schema{"thing", "", {{.name = "a", .type = T::number}, {.name = "list", .type = T::names}}}, table({}), problems);
    const auto kind = [](auto&& call) {
        try {
            call();
        } catch (const Error& error) {
            return error.kind();
        }
        return ErrorKind::memory;
    };
    EXPECT_EQ(kind([&] { values.number("b"); }), ErrorKind::internal);
    EXPECT_EQ(kind([&] { values.has("b"); }), ErrorKind::internal);
    EXPECT_EQ(kind([&] { values.number("a"); }), ErrorKind::internal);
    EXPECT_EQ(kind([&] { values.names("a"); }), ErrorKind::memory) << "an absent value read as a list is an empty list";
    EXPECT_TRUE(values.names("list").empty());
}

TEST(Schema, items_of_a_list_of_tables_are_checked_by_the_schema_their_key_chooses)
{
    const Parameter edits{
        .name = "edit",
        .type = T::tables,
        .discriminator = "tool",
        .items = {{"carve", "", {{.name = "radius", .type = T::length, .required = true}}}, {"fill", "", {{.name = "level", .type = T::length}}}}};
    const Schema schema{"stack", "", {edits}};
    std::vector<Problem> problems;
    const Values values = check(schema,
                                table({{"edit", value(Node::Array{table({{"tool", text("fill")}, {"level", whole(3)}}),
                                                                  table({{"tool", text("carve")}, {"radius", whole(2)}})})}}),
                                problems);
    ASSERT_TRUE(problems.empty()) << problems[0].text();
    ASSERT_EQ(values.tables("edit").size(), 2u);
    EXPECT_EQ(values.tables("edit")[0].variant(), "fill");
    EXPECT_EQ(values.tables("edit")[1].number("radius"), 2.0);

    check(schema,
          table({{"edit", value(Node::Array{table({{"tool", text("curve")}}), table({{"radius", whole(2)}}), whole(3),
                                            table({{"tool", text("fill")}, {"radius", whole(2)}})})}}),
          problems);
    ASSERT_EQ(problems.size(), 4u);
    EXPECT_EQ(problems[0].text(),
              "test.toml:1:1: tool has an unknown value, expected one of \"carve\", \"fill\", got \"curve\" (did you mean \"carve\")");
    EXPECT_EQ(problems[1].text(), "test.toml:1:1: an item of edit lacks the key \"tool\", expected one of \"carve\", \"fill\"");
    EXPECT_EQ(problems[2].text(), "test.toml:1:1: an item of edit has the wrong type, expected a table, got 3");
    EXPECT_EQ(problems[3].text(), "test.toml:1:1: unknown key \"radius\" in fill");
}

TEST(Schema, a_factory_can_report_a_problem_at_a_values_place)
{
    const Checked c = check_one({.type = T::length}, value(3.0, 7));
    EXPECT_EQ(c.values.problem("x", "x is too long for this map", "at most 2").what(),
              std::string("test.toml:1:7: x is too long for this map, expected at most 2"));
}
