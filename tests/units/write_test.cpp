// Pictures on the disk: what is read back is what was meant, by our reader and by other programs.
#include "tests/picture_files.h"

#include <fmt/format.h>

using namespace hoodoo;
using namespace hoodoo::testing;

TEST_F(Files, an_exr_reads_back_as_it_was_meant)
{
    const Image meant = picture();
    write_exr(meant, path("a.exr"));
    const Image found = read_exr(path("a.exr"));
    EXPECT_EQ(found.width, 40);
    EXPECT_EQ(found.height, 90);
    EXPECT_EQ(found.data.x0, 5);
    EXPECT_EQ(found.data.y1, 80);
    ASSERT_EQ(found.channels.size(), meant.channels.size());
    for (const Channel& channel : meant.channels) {
        const Channel* other = found.find(channel.name);
        ASSERT_TRUE(other) << channel.name;
        const bool exact =
            channel.name == "Z" || channel.name == "P.X" || channel.name == "objectId" || channel.name[0] == 'v' || channel.name[0] == 's';
        for (std::size_t i = 0; i < channel.pixels.size(); ++i) {
            if (exact) ASSERT_EQ(channel.pixels[i], other->pixels[i]) << channel.name;
            // A half has 11 significant bits, and steps of 2^-24 below 2^-14.
            else
                ASSERT_NEAR(channel.pixels[i], other->pixels[i], channel.pixels[i] * 0x1p-11f + 0x1p-25f) << channel.name;
        }
    }
    for (const auto& [name, value] : meant.metadata) EXPECT_EQ(found.metadata.at(name), value) << name;
}

TEST_F(Files, exrheader_and_oiiotool_agree_on_an_exr)
{
    write_exr(picture(), path("a.exr"));
    const std::string header = output_of("exrheader " + path("a.exr"));
    for (const char* line :
         {"compression (type compression): zip", "dataWindow (type box2i): (5 10) - (24 79)", "displayWindow (type box2i): (0 0) - (39 89)",
          "R, 16-bit floating-point", "Z, 32-bit floating-point", "P.X, 32-bit floating-point", "objectId, 32-bit floating-point",
          "variance.R, 32-bit floating-point", "capDate (type string): \"1970:01:01 00:00:00\"", "hoodoo:spp (type int): 64",
          "worldToCamera (type m44f)", "red   (0.713 0.293)", "hoodoo:seed (type string): \"18446744073709551615\""})
        EXPECT_NE(header.find(line), std::string::npos) << line << "\n" << header;
    // The value of the first row's second pixel, 1 / 1400 as a half, by a program that shares no code with our reader.
    const std::string dump = output_of("oiiotool --dumpdata " + path("a.exr"));
    EXPECT_NE(dump.find("Pixel (6, 10): 0.000714"), std::string::npos) << dump.substr(0, 400);
    EXPECT_NE(dump.find("16777215"), std::string::npos) << dump.substr(0, 400);
    const std::string info = output_of("oiiotool --info -v " + path("a.exr"));
    for (const char* text : {"pixel data origin: x=5, y=10", "full/display size: 40 x 90", "DateTime: \"1970:01:01 00:00:00\"", "hoodoo:spp: 64"})
        EXPECT_NE(info.find(text), std::string::npos) << text << "\n" << info;
}

TEST_F(Files, radiance_beyond_half_is_kept_in_floats)
{
    const float sun = 2.0e7f;  // W/m2/sr of the sun's disc: 1361 W/m2 over 6.8e-5 sr
    Image image = picture();
    image.channels[1].pixels[0] = sun;
    write_exr(image, path("sun.exr"));
    EXPECT_EQ(read_exr(path("sun.exr")).find("G")->pixels[0], sun);
    image.channels[1].pixels[0] = 65504.0f;
    write_exr(image, path("half.exr"));
    EXPECT_NE(output_of("exrheader " + path("half.exr")).find("G, 16-bit floating-point"), std::string::npos);
}

TEST_F(Files, full_precision_keeps_every_bit)
{
    const Image meant = picture();
    write_exr(meant, path("a.exr"), ExrPrecision::full);
    const Image found = read_exr(path("a.exr"));
    for (const Channel& channel : meant.channels) EXPECT_EQ(found.find(channel.name)->pixels, channel.pixels) << channel.name;
}

TEST_F(Files, equal_pictures_are_equal_files)
{
    write_exr(picture(), path("a.exr"));
    write_exr(picture(), path("b.exr"));
    write_exr(picture(0.5f), path("c.exr"));
    EXPECT_EQ(bytes_of(path("a.exr")), bytes_of(path("b.exr")));
    EXPECT_NE(bytes_of(path("a.exr")), bytes_of(path("c.exr")));
}

TEST_F(Files, a_png_is_clamped_rounded_and_marked_as_srgb)
{
    Image image;
    image.width = 6;
    image.height = 1;
    image.data = {0, 6, 0, 1};
    // 0.5 * 255 = 127.5 rounds up to 128; 0.1 * 255 = 25.5 lies a little above in floats; 0.2 * 255 = 51; 0.0019 * 255 = 0.4845 rounds to 0.
    for (const char* name : {"R", "G", "B"}) image.channels.push_back({name, {0.5f, 1.7f, -0.3f, 0.2f, 0.0019f, 1.0f}});
    write_png(image, path("a.png"), as_is, 0.0, true);
    const std::string dump = output_of("oiiotool --dumpdata " + path("a.png"));
    for (const char* text :
         {"Pixel (0, 0): 128 128 128", "Pixel (1, 0): 255 255 255", "Pixel (2, 0): 0 0 0", "Pixel (3, 0): 51 51 51", "Pixel (4, 0): 0 0 0"})
        EXPECT_NE(dump.find(text), std::string::npos) << text << "\n" << dump;
    const std::vector<char> bytes = bytes_of(path("a.png"));
    const std::string content(bytes.begin(), bytes.end());
    EXPECT_NE(content.find("sRGB"), std::string::npos);
    EXPECT_EQ(content.find("tIME"), std::string::npos);
    // One stop doubles: 0.2 -> 0.4 * 255 = 102.
    write_png(image, path("brighter.png"), as_is, 1.0, true);
    EXPECT_NE(output_of("oiiotool --dumpdata " + path("brighter.png")).find("Pixel (3, 0): 102 102 102"), std::string::npos);
}

TEST_F(Files, a_png_goes_through_the_display_transform)
{
    Image image;
    image.width = image.height = 1;
    image.data = {0, 1, 0, 1};
    for (const char* name : {"R", "G", "B"}) image.channels.push_back({name, {0.18f}});
    // 0.18 shows as 0.3560 in the ACES view (PyOpenColorIO): 90.78 rounds to 91.
    write_png(image, path("grey.png"), ColorConfig::built_in()->to_display("", ""), 0.0, true);
    EXPECT_NE(output_of("oiiotool --dumpdata " + path("grey.png")).find("Pixel (0, 0): 91 91 91"), std::string::npos);
}

TEST_F(Files, a_png_of_what_is_no_number_is_refused)
{
    Image image = picture();
    image.channels[0].pixels[21] = infinity;  // second row, second pixel
    EXPECT_EQ(outcome([&] { write_png(image, path("a.png"), as_is, 0.0, true); }), 3);
    try {
        write_png(image, "a.png", as_is, 0.0, true);
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "the file \"a.png\" cannot be written: the pixel (6, 11) is not a finite number");
    }
    EXPECT_TRUE(names().empty());
}

TEST_F(Files, a_broken_exr_is_an_error_and_no_crash)
{
    write_exr(picture(), path("a.exr"));
    const std::vector<char> bytes = bytes_of(path("a.exr"));
    for (const std::size_t size : {std::size_t{0}, std::size_t{3}, std::size_t{100}, bytes.size() / 2, bytes.size() - 1}) {
        std::ofstream(path("b.exr"), std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(size));
        EXPECT_EQ(outcome([&] { read_exr(path("b.exr")); }), 3) << size;
    }
    EXPECT_EQ(outcome([&] { read_exr(path("absent.exr")); }), 3);
}
