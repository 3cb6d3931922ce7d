// A full disk, a killed writer or a wrong path never leaves half a picture.
#include "tests/picture_files.h"

#include <fmt/format.h>

#include <atomic>
#include <csignal>
#include <thread>

#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>

using namespace hoodoo;
using namespace hoodoo::testing;

TEST_F(FilesInAChild, a_limit_on_file_size_leaves_the_old_file_and_no_other)
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

TEST_F(FilesInAChild, a_full_disk_leaves_the_old_file_and_no_other)
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

TEST_F(FilesInAChild, folders_that_cannot_be_written_are_named)
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

TEST_F(FilesInAChild, an_error_that_a_library_swallows_is_still_an_error)
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
