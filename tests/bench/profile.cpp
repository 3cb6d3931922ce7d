// SIGPROF samples addresses into a fixed buffer; afterwards `nm` names the functions of our library, and dladdr the other libraries.

#include "tests/bench/profile.h"

#include <dlfcn.h>
#include <sys/time.h>
#include <ucontext.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace hoodoo::bench
{
namespace
{

constexpr std::size_t kMost = 1 << 16;
std::array<std::uintptr_t, kMost> addresses;
std::atomic<std::size_t> taken{0};

void sample(int, siginfo_t*, void* context)
{
    const std::size_t i = taken.fetch_add(1, std::memory_order_relaxed);
    if (i < kMost) addresses[i] = static_cast<std::uintptr_t>(static_cast<ucontext_t*>(context)->uc_mcontext.gregs[REG_RIP]);
}

/// Functions of one file by address, from nm.
class Symbols
{
public:
    explicit Symbols(const std::string& file)
    {
        FILE* pipe = popen(("nm -C --defined-only '" + file + "' 2>/dev/null").c_str(), "r");
        if (!pipe) return;
        std::array<char, 8192> line;
        while (std::fgets(line.data(), line.size(), pipe)) {
            unsigned long address = 0;
            char kind = 0;
            int at = 0;
            if (std::sscanf(line.data(), "%lx %c %n", &address, &kind, &at) == 2 && (kind == 't' || kind == 'T' || kind == 'W' || kind == 'w')) {
                std::string name(line.data() + at);
                while (!name.empty() && name.back() == '\n') name.pop_back();
                functions_.emplace_back(address, name);
            }
        }
        pclose(pipe);
        std::sort(functions_.begin(), functions_.end());
    }
    std::string name(std::uintptr_t offset) const
    {
        const auto next = std::upper_bound(functions_.begin(), functions_.end(), offset, [](std::uintptr_t a, const auto& f) { return a < f.first; });
        return next == functions_.begin() ? std::string() : std::prev(next)->second;
    }

private:
    std::vector<std::pair<std::uintptr_t, std::string>> functions_;
};

}  // namespace

std::map<std::string, double> profile(const std::function<void()>& work, const std::function<std::string(const std::string&)>& classify)
{
    taken = 0;
    struct sigaction action = {}, before = {};
    action.sa_sigaction = sample;
    action.sa_flags = SA_SIGINFO | SA_RESTART;
    sigaction(SIGPROF, &action, &before);
    itimerval every{{0, 1000}, {0, 1000}}, never{};
    setitimer(ITIMER_PROF, &every, nullptr);
    work();
    setitimer(ITIMER_PROF, &never, nullptr);
    sigaction(SIGPROF, &before, nullptr);

    std::map<std::string, Symbols> symbols;
    std::map<std::string, double> shares;
    const std::size_t count = std::min<std::size_t>(taken, kMost);
    for (std::size_t i = 0; i < count; ++i) {
        Dl_info info;
        std::string name = "unknown";
        if (dladdr(reinterpret_cast<void*>(addresses[i]), &info) && info.dli_fname) {
            const std::string file = info.dli_fname;
            name = file;
            if (file.find("libhoodoo") != std::string::npos) {
                const auto [found, made] = symbols.try_emplace(file, file);
                name = found->second.name(addresses[i] - reinterpret_cast<std::uintptr_t>(info.dli_fbase));
            }
        }
        shares[classify(name)] += 1.0 / static_cast<double>(count);
    }
    return shares;
}

}  // namespace hoodoo::bench
