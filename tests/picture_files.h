// Pictures on the disk for tests: a picture with all that is hard to keep, a folder of its own for each test, and a child process to fail in.
#pragma once

#include "terrain/io/atomic_file.h"
#include "renderer/film/write.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>

#include <sys/wait.h>
#include <unistd.h>

namespace hoodoo::testing
{

inline const float infinity = std::numeric_limits<float>::infinity();

/// 70 rows: more than one band of rows, and no multiple of one.
inline Image picture(float brightness = 1.0f)
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

inline std::vector<char> bytes_of(const std::string& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

inline std::string output_of(const std::string& command)
{
    std::string output;
    if (FILE* pipe = ::popen((command + " 2>&1").c_str(), "r")) {
        char buffer[4096];
        while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) output.append(buffer, n);
        if (::pclose(pipe) != 0) output += "\n(failed)";
    }
    return output;
}

inline int outcome_code(const std::function<int()>& work)
{
    try {
        return work();
    } catch (...) {
        return 99;
    }
}

/// Runs `work` in a child process; its value is the exit code, 99 for an exception, -1 for a signal.
inline int in_child(const std::function<int()>& work)
{
    const pid_t child = ::fork();
    if (child == 0) ::_exit(outcome_code(work));
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// 0 written, 3 refused with an Error of kind `file`, 9 anything else.
inline int outcome(const std::function<void()>& write)
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

inline const ColorTransform as_is = [](std::span<Vec3f>) {};

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

/// For tests with a child process. A library's threads, started by another test of this process, do not live on in a child and would be waited for:
/// such a test needs a process of its own, as ctest gives it.
class FilesInAChild : public Files
{
protected:
    void SetUp() override
    {
        Files::SetUp();
        if (::testing::UnitTest::GetInstance()->test_to_run_count() > 1) GTEST_SKIP() << "needs a process of its own";
    }
};

}  // namespace hoodoo::testing
