#pragma once
// A limit of this process, as a full disk or too many open files: setrlimit, for the life of the object.
#include <sys/resource.h>

#include <csignal>

namespace knap::tests {

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

}  // namespace knap::tests
