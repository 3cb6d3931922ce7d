// Progress and signals. The time left is the time spent times (1 - f) / f: right for work in equal pieces, which tiles in random order nearly are.
#include "renderer/hosts/cli.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <unistd.h>

namespace hoodoo::cli
{

std::string clock_text(double seconds)
{
    const auto s = static_cast<long>(std::clamp(seconds + 0.5, 0.0, 1e8));
    return s >= 3600 ? fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60) : fmt::format("{}:{:02}", s / 60, s % 60);
}

Progress::Progress(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress()
{
    finish();
}

void Progress::update(double fraction, const std::string& what)
{
    if (quiet_) return;
    const std::lock_guard lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (what != what_) {
        if (drawn_) std::fputc('\n', stderr);
        drawn_ = false;
        what_ = what;
        shown_ = terminal_ ? -1 : 0;  // no line for nothing done
        start_ = now;
        last_ = {};
    }
    fraction = std::clamp(fraction, 0.0, 1.0);
    const int step = static_cast<int>(fraction * (terminal_ ? 100 : 10));
    const bool late = terminal_ && drawn_ && now - last_ >= std::chrono::seconds(1);  // the clock goes on
    if (step <= shown_ && !late) return;
    if (terminal_ && fraction < 1.0 && now - last_ < std::chrono::milliseconds(100)) return;
    shown_ = std::max(step, shown_);
    last_ = now;
    draw(fraction, std::chrono::duration<double>(now - start_).count());
    drawn_ = terminal_;
}

void Progress::draw(double fraction, double seconds) const
{
    const bool known = fraction > 0.0 && seconds > 0.2;
    const double left = known ? seconds * (1.0 - fraction) / fraction : 0.0;
    if (!terminal_) {
        const std::string rest = fraction < 1.0 && known ? ", " + clock_text(left) + " left" : "";
        fmt::print(stderr, "{} {:3.0f}%  {}{}\n", what_, fraction * 100.0, clock_text(seconds), rest);
    } else {
        constexpr int width = 40;
        const int full = static_cast<int>(fraction * width);
        const std::string rest = fraction >= 1.0 ? clock_text(seconds) : known ? clock_text(left) + " left" : "";
        fmt::print(stderr, "\r\x1b[K{} [{}{}] {:3.0f}%  {}", what_, std::string(full, '#'), std::string(width - full, '.'), fraction * 100.0, rest);
    }
    std::fflush(stderr);
}

void Progress::finish()
{
    const std::lock_guard lock(mutex_);
    if (drawn_) std::fputc('\n', stderr);
    drawn_ = false;
}

// -- Signals. A handler may touch nothing but lock-free atomics: these are the process's, as signals are.
// --------------------------------------------

namespace
{

std::atomic<bool> cancelled{false};
std::atomic<bool> rendering{false};
std::atomic<int> received{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

extern "C" void on_signal(int number)
{
    // The second signal, or one while nothing is at stake, ends the program at once. Pictures are renamed into place, so none is ever half written.
    if (!rendering.load() || received.exchange(number) != 0) ::_exit(128 + number);
    cancelled.store(true);
}

}  // namespace

void catch_signals()
{
    struct sigaction action {
    };
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    for (const int number : {SIGINT, SIGTERM}) {
        struct sigaction before {
        };
        ::sigaction(number, nullptr, &before);
        if (before.sa_handler != SIG_IGN) ::sigaction(number, &action, nullptr);  // a shell's background job ignores SIGINT: so do we
    }
    std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is an error of writing, not a death
}

const std::atomic<bool>* guard_render()
{
    rendering.store(true);
    return &cancelled;
}

int signal_exit_code()
{
    const int number = received.load();
    return number ? 128 + number : 0;
}

}  // namespace hoodoo::cli
