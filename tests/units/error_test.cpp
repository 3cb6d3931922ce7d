#include "terrain/error.h"

#include <gtest/gtest.h>

using hoodoo::Error;
using hoodoo::ErrorKind;
using hoodoo::nearest_name;
using hoodoo::Problem;

TEST(Error, text_has_the_place_the_expectation_the_nearest_name_and_a_caret)
{
    const Problem problem{
        {"cave.toml", 3, 5, "    filter = \"gausian\""}, "filter has an unknown value", "one of \"box\", \"gaussian\"", "\"gausian\"", "gaussian"};
    EXPECT_EQ(problem.text(),
              "cave.toml:3:5: filter has an unknown value, expected one of \"box\", \"gaussian\", got \"gausian\" (did you mean \"gaussian\")\n"
              "        filter = \"gausian\"\n"
              "        ^");
}

TEST(Error, text_of_a_problem_without_a_place_is_its_sentence)
{
    EXPECT_EQ(Error(ErrorKind::file, "the disk is full").what(), std::string("the disk is full"));
}

TEST(Error, caret_counts_letters_not_bytes)
{
    // "höhe" is five bytes and four letters: column 8 is the value behind "höhe = ".
    const Problem problem{{"a.toml", 1, 8, "h\xc3\xb6he = 3"}, "wrong", {}, {}, {}};
    EXPECT_EQ(problem.text(), "a.toml:1:8: wrong\n    h\xc3\xb6he = 3\n           ^");
}

TEST(Error, no_caret_where_the_line_is_too_short_for_it)
{
    const Problem problem{{"a.toml", 1, 40, "x = 3"}, "wrong", {}, {}, {}};
    EXPECT_EQ(problem.text(), "a.toml:1:40: wrong\n    x = 3");
}

TEST(Error, control_characters_of_a_scene_do_not_reach_the_terminal)
{
    const Problem problem{{"a\x1b[2J.toml", 1, 1, "\x1b[31m\tred"}, "wrong", {}, "\"\x07\"", {}};
    for (const char c : problem.text()) EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 || c == '\n') << static_cast<int>(c);
}

TEST(Error, a_long_value_is_quoted_in_part_and_cut_between_letters)
{
    // 159 letters of one byte, then letters of two: the cut at 160 bytes would split the first of them.
    std::string got(159, 'a');
    for (int i = 0; i < 50; ++i) got += "\xc3\xb6";
    const Problem problem{{}, "wrong", {}, got, {}};
    EXPECT_EQ(problem.text(), "wrong, got " + std::string(159, 'a') + "...");
}

TEST(Error, shows_a_hundred_problems_and_counts_the_rest)
{
    const Error error(ErrorKind::scene, std::vector<Problem>(103, Problem{{}, "wrong", {}, {}, {}}));
    const std::string text = error.what();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 100);
    EXPECT_TRUE(text.ends_with("and 3 more problems"));
    EXPECT_EQ(error.problems().size(), 103u);
}

TEST(NearestName, finds_one_typing_error_of_each_kind)
{
    const std::vector<std::string> names{"sigma", "height", "material"};
    EXPECT_EQ(nearest_name("sgima", names), "sigma");         // two neighbours swapped
    EXPECT_EQ(nearest_name("heigt", names), "height");        // one left out
    EXPECT_EQ(nearest_name("materiall", names), "material");  // one too many
    EXPECT_EQ(nearest_name("sigmo", names), "sigma");         // one replaced
}

TEST(NearestName, is_silent_where_more_than_a_third_of_the_letters_differ)
{
    EXPECT_EQ(nearest_name("abcdef", {"abcxyz"}), "");        // 3 of 6
    EXPECT_EQ(nearest_name("abcdef", {"abcdxy"}), "abcdxy");  // 2 of 6: exactly a third
    EXPECT_EQ(nearest_name("colour", {"spp", "width"}), "");
    EXPECT_EQ(nearest_name("x", {}), "");
}

TEST(NearestName, prefers_the_first_of_equally_near_names)
{
    EXPECT_EQ(nearest_name("eye2", {"eye1", "eye3"}), "eye1");
}
