#include "app/cli.hpp"
#include "app/run.hpp"
#include "app/threads.hpp"
#include "base/error.hpp"

#include <cstdio>

// Exceptions become exit codes.
int main(int argc, char** argv) {
    knap::let_waiting_threads_sleep(argv);
    try {
        const int code = knap::run_command_line(argc, argv);
        if (std::fflush(stdout) != 0 || std::ferror(stdout)) throw knap::OutputError("cannot write to standard output");
        return code;
    } catch (const knap::UserError& error) {
        std::fputs(error.what(), stderr);
        const std::size_t n = error.diagnostics.size();
        std::fprintf(stderr, "%zu error%s, nothing was run.\n", n, n == 1 ? "" : "s");
        return knap::exit_bad_input;
    } catch (const knap::SimulationError& error) {
        std::fprintf(stderr, "error[failed]: %s\n", error.what());
        return knap::exit_failed;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "error[internal]: %s\n", error.what());
        return knap::exit_internal;
    }
}
