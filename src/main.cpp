#include "app/cli.hpp"
#include "app/run/run.hpp"
#include "app/setup/process.hpp"
#include "base/error.hpp"
#include "base/terminal.hpp"
#include "base/text.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>

namespace {

/// Replaces closed standard streams: the first file opened would take the place of one, and messages would go into it.
void open_standard_streams() {
    int file;
    do file = open("/dev/null", O_RDWR);
    while (file >= 0 && file <= STDERR_FILENO);
    if (file >= 0) close(file);
}

/// Whether the reader of a pipe has closed it.
bool reader_is_gone(int file) {
    pollfd request{.fd = file, .events = POLLOUT, .revents = 0};
    return poll(&request, 1, 0) > 0 && (request.revents & POLLERR) != 0;
}

/// The relocatable archive contains the font: tells Fontconfig its place, unless the user has set one.
void find_own_font() {
    std::error_code none;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", none);
    const std::filesystem::path fonts = program.parent_path().parent_path() / "share/knap/fonts.conf";
    if (std::filesystem::exists(fonts, none)) setenv("FONTCONFIG_FILE", fonts.c_str(), 0);
}

void print_error(const std::string& message) { knap::print_messages(knap::printable(message) + "\n"); }

}  // namespace

// Exceptions become exit codes.
int main(int argc, char** argv) {
    open_standard_streams();
    std::signal(SIGPIPE, SIG_IGN);  // a reader of the messages who closes the pipe
    std::signal(SIGXFSZ, SIG_IGN);  // a file size limit is an error like a full disk
    find_own_font();
    knap::let_waiting_threads_sleep(argv);
    knap::end_when_interrupted();
    try {
        const int code = knap::run_command_line(argc, argv);
        const bool written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
        if (!written && !reader_is_gone(STDOUT_FILENO)) throw knap::OutputError("cannot write to standard output");
        return code;
    } catch (const knap::UserError& error) {
        knap::print_messages(error.what());
        const std::size_t n = error.diagnostics.size();
        std::fprintf(stderr, "%zu error%s, nothing was run.\n", n, n == 1 ? "" : "s");
        return knap::exit_bad_input;
    } catch (const knap::SimulationError& error) {
        print_error("error[failed]: " + std::string(error.what()));
        return knap::exit_failed;
    } catch (const std::filesystem::filesystem_error& error) {  // of a path that the user gave
        print_error("error[file]: `" + error.path1().string() + "`: " + error.code().message());
        return knap::exit_bad_input;
    } catch (const std::bad_alloc&) {  // printed without allocating
        std::fputs(
            "error[out-of-memory]: there is not enough memory\n = a larger mesh.size and mesh.order = 1 need less\n",
            stderr);
        return knap::exit_failed;
    } catch (const std::exception& error) {
        print_error("error[internal]: " + std::string(error.what()));
        return knap::exit_internal;
    }
}
