#pragma once
// A limit of this process, as a full disk or too many open files, and what an action that meets it says.
#include "base/error.hpp"

#include <sys/resource.h>

#include <csignal>
#include <string>

namespace knap::tests {

/// Sets a limit (setrlimit) for the life of the object.
class Limited {
public:
    Limited(__rlimit_resource_t what, rlim_t limit) : what_(what), handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(what_, &before_);
        const rlimit now{.rlim_cur = limit, .rlim_max = before_.rlim_max};
        setrlimit(what_, &now);
    }
    ~Limited() {
        setrlimit(what_, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    Limited(const Limited&) = delete;
    Limited& operator=(const Limited&) = delete;

private:
    __rlimit_resource_t what_;
    rlimit before_{};
    void (*handler_)(int);
};

/// The text of the OutputError with which an action ends; empty where it succeeds.
std::string output_error_of(const auto& action) {
    try {
        action();
    } catch (const OutputError& error) {
        return error.what();
    }
    return "";
}

}  // namespace knap::tests
