// Ranges of frames and numbered names.
#include "renderer/scene/frames.h"

#include "terrain/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using ::testing::ElementsAre;

std::string refusal(const std::string& text)
{
    try {
        parse_frames(text);
        return "none";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::scene);
        return error.what();
    }
}

TEST(Frames, ranges_are_read_as_farms_write_them)
{
    EXPECT_THAT(parse_frames("7"), ElementsAre(7));
    EXPECT_THAT(parse_frames("1-4"), ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(parse_frames("1-3,20-30x4"), ElementsAre(1, 2, 3, 20, 24, 28));
    EXPECT_THAT(parse_frames("3-1"), ElementsAre(3, 2, 1));
    EXPECT_THAT(parse_frames("-2-1"), ElementsAre(-2, -1, 0, 1));
    EXPECT_THAT(parse_frames("1-3,2-4"), ElementsAre(1, 2, 3, 4)) << "repeats are left out";
}

TEST(Frames, what_is_no_range_is_quoted)
{
    const std::string expected = "this is no range of frames, expected N, N-M or N-MxS with commas between, such as 1-10,20-50x2, got ";
    EXPECT_EQ(refusal("1-"), expected + "\"1-\"");
    EXPECT_EQ(refusal("1-5,a"), expected + "\"a\"");
    EXPECT_EQ(refusal("1-5x0"), expected + "\"1-5x0\"");
    EXPECT_EQ(refusal("1..5"), expected + "\"1..5\"");
    EXPECT_EQ(refusal("1,"), expected + "\"\"");
    EXPECT_EQ(refusal("99999999999"), expected + "\"99999999999\"");
    EXPECT_EQ(refusal("1-2000000"), "these are too many frames, expected at most 1000000, got \"1-2000000\"");
}

TEST(Frames, names_have_one_place_for_the_frame)
{
    EXPECT_EQ(frame_path("out/wave.####.exr", 17), "out/wave.0017.exr");
    EXPECT_EQ(frame_path("wave.%04d.exr", 17), "wave.0017.exr");
    EXPECT_EQ(frame_path("wave%d.exr", 17), "wave17.exr");
    EXPECT_EQ(frame_path("#.exr", 12345), "12345.exr");
    EXPECT_EQ(frame_path("w.###.exr", -5), "w.-005.exr");
    EXPECT_EQ(frame_path("100%.exr", 3), "100%.exr");
    EXPECT_TRUE(names_frames("a.##.png"));
    EXPECT_FALSE(names_frames("a.png"));
    EXPECT_THROW(frame_path("a.##.b.##.exr", 1), Error);
}

}  // namespace
}  // namespace hoodoo
