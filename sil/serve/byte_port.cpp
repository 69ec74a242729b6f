#include "sil/serve/byte_port.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <utility>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "sil/scenario/document.h"

namespace serve
{

namespace
{

constexpr std::size_t most_kept_bytes = 65536; /* for a program that does not read */

[[noreturn]] void fail(const std::string &what)
{
    throw scenario::InputError("serve: " + what + ": " + std::strerror(errno));
}

/* No echo, no line editing, eight bits: what a serial adapter hands through. */
void make_raw(int terminal)
{
    termios mode = {};
    if (tcgetattr(terminal, &mode) == 0) {
        cfmakeraw(&mode);
        tcsetattr(terminal, TCSANOW, &mode);
    }
}

/* As much as goes. */
void flush(int file, std::string &bytes)
{
    while (!bytes.empty()) {
        const ssize_t written = ::write(file, bytes.data(), bytes.size());
        if (written <= 0) {
            return;
        }
        bytes.erase(0, static_cast<std::size_t>(written));
    }
}

void keep(std::string &kept, const std::string &bytes)
{
    if (kept.size() + bytes.size() <= most_kept_bytes) {
        kept += bytes;
    }
}

bool ends_line(char byte)
{
    return byte == '\n' || byte == '\r' || byte == '\a';
}

/* While `skips`, nothing up to the end of the line that is being written. */
std::string behind_line(const std::string &bytes, bool &skips)
{
    std::size_t begin = 0;
    while (skips && begin < bytes.size()) {
        skips = !ends_line(bytes[begin++]);
    }
    return bytes.substr(begin);
}

/* false: whoever wrote is gone. */
bool read_all(int file, std::string &bytes)
{
    char piece[4096];
    ssize_t count = 0;
    while ((count = ::read(file, piece, sizeof piece)) > 0) {
        bytes.append(piece, static_cast<std::size_t>(count));
    }
    return count < 0 && (errno == EAGAIN || errno == EINTR);
}

constexpr const char *http_methods[] = {"GET ",     "HEAD ",  "POST ",  "PUT ",    "DELETE ",
                                        "OPTIONS ", "PATCH ", "TRACE ", "CONNECT "};

bool is_http(const std::string &bytes)
{
    return std::any_of(std::begin(http_methods), std::end(http_methods),
                       [&bytes](const std::string &method) {
                           return bytes.compare(0, method.size(), method) == 0;
                       });
}

bool may_become_http(const std::string &bytes)
{
    return std::any_of(std::begin(http_methods), std::end(http_methods),
                       [&bytes](const std::string &method) {
                           return method.compare(0, bytes.size(), bytes) == 0;
                       });
}

} // namespace

BytePort::BytePort(const PortPlace &place) : place_(place)
{
    try {
        open_terminal();
        if (!place_.link.empty()) {
            link_terminal();
        }
        if (place_.tcp) {
            listen(*place_.tcp);
        }
    } catch (...) {
        this->~BytePort();
        throw;
    }
}

BytePort::~BytePort()
{
    if (linked_) {
        unlink(place_.link.c_str());
        linked_ = false;
    }
    for (int *file : {&terminal_, &listener_, &client_}) {
        if (*file >= 0) {
            close(*file);
            *file = -1;
        }
    }
}

void BytePort::open_terminal()
{
    terminal_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    char name[128];
    if (terminal_ < 0 || grantpt(terminal_) != 0 || unlockpt(terminal_) != 0 ||
        ptsname_r(terminal_, name, sizeof name) != 0) {
        fail("a pseudo-terminal");
    }
    terminal_name_ = name;
    make_raw(terminal_);
    /* opened and closed once, it says from now on whether somebody has it open */
    if (!empty_terminal()) {
        fail(terminal_name_);
    }
}

/* What waits for a reader lies at the other end. */
bool BytePort::empty_terminal() const
{
    const int other_end = open(terminal_name_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (other_end < 0) {
        return false;
    }
    tcflush(other_end, TCIFLUSH);
    close(other_end);
    return true;
}

/* A link that an earlier server has left is replaced, anything else is not. */
void BytePort::link_terminal()
{
    struct stat found = {};
    if (lstat(place_.link.c_str(), &found) == 0 && S_ISLNK(found.st_mode)) {
        unlink(place_.link.c_str());
    }
    if (symlink(terminal_name_.c_str(), place_.link.c_str()) != 0) {
        fail(place_.link);
    }
    linked_ = true;
}

void BytePort::listen(unsigned port)
{
    const std::string name = "127.0.0.1:" + std::to_string(port);
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    const int on = 1;
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (listener_ < 0 || setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0 ||
        bind(listener_, reinterpret_cast<const sockaddr *>(&address), size) != 0 ||
        ::listen(listener_, 1) != 0 ||
        getsockname(listener_, reinterpret_cast<sockaddr *>(&address), &size) != 0) {
        fail(name);
    }
    tcp_port_ = ntohs(address.sin_port);
}

std::vector<std::string> BytePort::places() const
{
    std::vector<std::string> names = {terminal_name_};
    if (linked_) {
        names.push_back(place_.link);
    }
    if (listener_ >= 0) {
        names.push_back("127.0.0.1:" + std::to_string(tcp_port_));
    }
    return names;
}

void BytePort::watch(std::vector<pollfd> &watched) const
{
    if (terminal_open_) {
        watched.push_back({terminal_, POLLIN, 0});
    }
    if (listener_ >= 0) {
        watched.push_back({client_ >= 0 ? client_ : listener_, POLLIN, 0});
    }
}

/* Bytes that nobody has read are not for the next who opens it. */
void BytePort::look_at_terminal()
{
    pollfd state = {terminal_, 0, 0};
    poll(&state, 1, 0);
    const bool open_now = (state.revents & POLLHUP) == 0;
    if (terminal_open_ && !open_now) {
        to_terminal_.clear();
        empty_terminal();
        make_raw(terminal_);
    }
    terminal_skips_ = terminal_open_ ? terminal_skips_ : in_line_;
    terminal_open_ = open_now;
}

/* One at a time: who comes while another is there waits. */
void BytePort::accept_client()
{
    if (listener_ < 0 || client_ >= 0) {
        return;
    }
    client_ = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (client_ >= 0) {
        client_known_ = false;
        client_begin_.clear();
        client_skips_ = in_line_;
        const int on = 1;
        setsockopt(client_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    }
}

void BytePort::close_client()
{
    close(client_);
    client_ = -1;
    client_begin_.clear();
    to_client_.clear();
}

std::string BytePort::read()
{
    std::string bytes;
    read_all(terminal_, bytes); /* what was written before it was closed, too */
    look_at_terminal();
    accept_client();
    return bytes + read_client();
}

/* Of one that may yet turn out to be a browser nothing. */
std::string BytePort::read_client()
{
    std::string bytes;
    const bool is_there = client_ < 0 || read_all(client_, bytes);
    if (!client_known_) {
        client_begin_ += bytes;
        client_known_ = !may_become_http(client_begin_) && !is_http(client_begin_);
        bytes = client_known_ ? std::exchange(client_begin_, {}) : "";
    }
    if (!is_there || is_http(client_begin_)) {
        close_client();
    }
    return bytes;
}

void BytePort::write(const std::string &bytes, bool more_comes)
{
    if (terminal_open_) {
        keep(to_terminal_, behind_line(bytes, terminal_skips_));
        flush(terminal_, to_terminal_);
    }
    if (client_ >= 0) {
        keep(to_client_, behind_line(bytes, client_skips_));
        flush(client_, to_client_);
    }
    in_line_ = more_comes && (bytes.empty() ? in_line_ : !ends_line(bytes.back()));
    terminal_skips_ = terminal_skips_ && in_line_;
    client_skips_ = client_skips_ && in_line_;
}

} // namespace serve
