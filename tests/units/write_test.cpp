// Pictures on the disk: what is read back is what was meant, by our reader and by other programs; and a full disk, a killed writer or a wrong path
// never leaves half a picture.
#include "renderer/film/atomic_file.h"
#include "renderer/film/write.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <thread>

#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace hoodoo;

namespace
{

const float infinity = std::numeric_limits<float>::infinity();

/// 70 rows: more than one band of rows, and no multiple of one.
Image picture(float brightness = 1.0f)
{
    Image image;
    image.width = 40;
    image.height = 90;
    image.data = {5, 25, 10, 80};
    const std::size_t pixels = 20 * 70;
    for (const char* name : {"R", "G", "B", "A", "Z", "N.X", "P.X", "albedo.R", "material.sand", "objectId", "variance.R", "samples.Y"}) {
        Channel channel{name, std::vector<float>(pixels)};
        for (std::size_t i = 0; i < pixels; ++i) channel.pixels[i] = brightness * static_cast<float>(i) / pixels;
        image.channels.push_back(std::move(channel));
    }
    for (Channel& channel : image.channels) {
        if (channel.name == "Z") channel.pixels[7] = infinity;
        if (channel.name == "P.X") channel.pixels[3] = 4000000.25f;                                            // a map's coordinates need all bits
        if (channel.name == "objectId") std::fill(channel.pixels.begin(), channel.pixels.end(), 16777215.0f);  // 2^24 - 1
    }
    image.metadata["hoodoo:seed"] = std::string("18446744073709551615");
    image.metadata["hoodoo:spp"] = 64;
    image.metadata["hoodoo:renderTime"] = 1.5f;
    image.metadata["DateTime"] = std::string("1970:01:01 00:00:00");
    image.metadata["chromaticities"] = std::vector<float>{0.713f, 0.293f, 0.165f, 0.830f, 0.128f, 0.044f, 0.32168f, 0.33767f};
    image.metadata["worldToCamera"] = std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};
    return image;
}

std::vector<char> bytes_of(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::string output_of(const std::string& command)
{
    std::string output;
    if (FILE* pipe = ::popen((command + " 2>&1").c_str(), "r")) {
        char buffer[4096];
        while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) output.append(buffer, n);
        if (::pclose(pipe) != 0) output += "\n(failed)";
    }
    return output;
}

int outcome_code(const std::function<int()>& work)
{
    try {
        return work();
    } catch (...) {
        return 99;
    }
}

/// Runs `work` in a child process; its value is the exit code, 99 for an exception, -1 for a signal.
int in_child(const std::function<int()>& work)
{
    const pid_t child = ::fork();
    if (child == 0) ::_exit(outcome_code(work));
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// 0 written, 3 refused with an Error of kind `file`, 9 anything else.
int outcome(const std::function<void()>& write)
{
    try {
        write();
        return 0;
    } catch (const Error& error) {
        return error.kind() == ErrorKind::file ? 3 : 9;
    } catch (...) {
        return 9;
    }
}

const ColorTransform as_is = [](std::span<Vec3f>) {};

class Files : public ::testing::Test
{
protected:
    void SetUp() override
    {
        folder_ = std::filesystem::path(::testing::TempDir()) / fmt::format("hoodoo_write_{}", ::getpid());
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::vector<std::string> names() const
    {
        std::vector<std::string> found;
        for (const auto& entry : std::filesystem::directory_iterator(folder_)) found.push_back(entry.path().filename().string());
        return found;
    }
    std::filesystem::path folder_;
};

}  // namespace

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

TEST_F(Files, a_limit_on_file_size_leaves_the_old_file_and_no_other)
{
    // RLIMIT_FSIZE cuts a file at any byte as a full disk does. Sizes from one byte to one less than the picture needs.
    for (const char* name : {"a.exr", "a.png"}) {
        const auto write = [&](float brightness) {
            if (name[2] == 'e')
                write_exr(picture(brightness), path(name));
            else
                write_png(picture(brightness), path(name), as_is, 0.0, true);
        };
        write(0.5f);
        const std::vector<char> old = bytes_of(path(name));
        write(1.0f);
        const std::size_t size = bytes_of(path(name)).size();
        write(0.5f);
        for (int k = 0; k < 15; ++k) {
            const std::size_t limit = k < 5 ? size - 1 - k : 1 + (size - 6) * (k - 5) / 10;
            const int result = in_child([&] {
                ::signal(SIGXFSZ, SIG_IGN);
                const rlimit bytes{limit, limit};
                ::setrlimit(RLIMIT_FSIZE, &bytes);
                return outcome([&] { write(1.0f); });
            });
            EXPECT_EQ(result, 3) << name << " cut at " << limit << " of " << size;
            EXPECT_EQ(bytes_of(path(name)), old) << name << " cut at " << limit;
            EXPECT_EQ(names().size(), 1u) << "a temporary file is left";
        }
        EXPECT_EQ(in_child([&] { return outcome([&] { write(1.0f); }); }), 0);  // the child itself can write
        std::filesystem::remove(path(name));
    }
}

TEST_F(Files, a_full_disk_leaves_the_old_file_and_no_other)
{
    // A file system of its own in a namespace of its own: 64 KB, filled up to less than the picture.
    const int result = in_child([&] {
        const uid_t user = ::geteuid();
        const gid_t group = ::getegid();
        if (::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return 77;
        std::ofstream("/proc/self/setgroups") << "deny";
        std::ofstream("/proc/self/uid_map") << "0 " << user << " 1";
        std::ofstream("/proc/self/gid_map") << "0 " << group << " 1";
        if (::mount("tmpfs", folder_.c_str(), "tmpfs", 0, "size=64k") != 0) return 77;
        if (outcome([&] { write_exr(picture(0.5f), path("a.exr")); }) != 0) return 4;
        const std::vector<char> old = bytes_of(path("a.exr"));
        std::ofstream(path("filler")) << std::string(1 << 20, 'x');
        for (const char* name : {"a.exr", "a.png", "b.exr"}) {
            const bool exr = name[2] == 'e';
            if (outcome([&] { exr ? write_exr(picture(), path(name)) : write_png(picture(), path(name), as_is, 0.0, true); }) != 3) return 1;
        }
        if (bytes_of(path("a.exr")) != old) return 2;
        return names().size() == 2 ? 0 : 3;  // the picture and the filler
    });
    if (result == 77) GTEST_SKIP() << "no file system may be mounted here";
    EXPECT_EQ(result, 0);
}

TEST_F(Files, folders_that_cannot_be_written_are_named)
{
    try {
        write_exr(picture(), path("absent/a.exr"));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::file);
        EXPECT_EQ(error.what(), fmt::format("the file \"{}\" cannot be created: No such file or directory", path("absent/a.exr")));
    }
    std::ofstream(path("plain")) << "a file";
    EXPECT_EQ(outcome([&] { write_exr(picture(), path("plain/a.exr")); }), 3);
    EXPECT_EQ(outcome([&] { write_exr(picture(), "/proc/a.exr"); }), 3);
    // Somebody without rights, since the tests may run as root.
    std::filesystem::create_directories(folder_ / "closed");
    ::chmod(path("closed").c_str(), 0555);
    EXPECT_EQ(in_child([&] {
                  if (::geteuid() == 0 && ::setuid(65534) != 0) return 3;
                  return outcome([&] { write_exr(picture(), path("closed/a.exr")); });
              }),
              3);
}

TEST_F(Files, only_regular_files_are_replaced)
{
    ASSERT_EQ(::mkfifo(path("a.exr").c_str(), 0600), 0);
    std::filesystem::create_directories(folder_ / "b.exr");
    EXPECT_EQ(outcome([&] { write_exr(picture(), path("a.exr")); }), 3);
    EXPECT_EQ(outcome([&] { write_exr(picture(), path("b.exr")); }), 3);
    EXPECT_EQ(names().size(), 2u);
}

TEST_F(Files, a_file_that_does_not_verify_gets_no_name)
{
    const auto produce = [](ByteSink& sink) { sink.write("new", 3); };
    write_atomically(
        path("a"), [](ByteSink& sink) { sink.write("old", 3); }, [](const std::string&) {});
    EXPECT_EQ(outcome([&] { write_atomically(path("a"), produce, [](const std::string&) { throw std::runtime_error("it differs"); }); }), 3);
    EXPECT_EQ(bytes_of(path("a")), std::vector<char>({'o', 'l', 'd'}));
    EXPECT_EQ(names().size(), 1u);
    // Verification sees the finished file under its temporary name.
    write_atomically(path("a"), produce, [](const std::string& temporary) { EXPECT_EQ(bytes_of(temporary), std::vector<char>({'n', 'e', 'w'})); });
    EXPECT_EQ(bytes_of(path("a")), std::vector<char>({'n', 'e', 'w'}));
}

TEST_F(Files, an_error_that_a_library_swallows_is_still_an_error)
{
    const int result = in_child([&] {
        ::signal(SIGXFSZ, SIG_IGN);
        const rlimit bytes{2, 2};
        ::setrlimit(RLIMIT_FSIZE, &bytes);
        const auto careless = [](ByteSink& sink) {
            try {
                sink.write("three", 5);
            } catch (const std::exception&) {
                return;  // as a destructor does
            }
        };
        return outcome([&] { write_atomically(path("a"), careless, [](const std::string&) {}); });
    });
    EXPECT_EQ(result, 3);
    EXPECT_TRUE(names().empty());
}

TEST_F(Files, a_reader_never_sees_half_a_picture)
{
    write_exr(picture(), path("a.exr"));
    std::atomic<bool> done{false};
    int reads = 0, failures = 0;
    std::thread reader([&] {
        while (!done) {
            ++reads;
            try {
                if (read_exr(path("a.exr")).data.width() != 20) ++failures;
            } catch (const Error&) {
                ++failures;
            }
        }
    });
    for (int k = 0; k < 20; ++k) write_exr(picture(0.1f * static_cast<float>(k)), path("a.exr"));
    done = true;
    reader.join();
    EXPECT_GT(reads, 0);
    EXPECT_EQ(failures, 0);
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
