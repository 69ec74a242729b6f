/*
 * A line of bytes that other programs open: a pseudo-terminal, as a serial adapter would be, and,
 * if asked for, TCP on the loopback interface. What comes in on either is one stream; what goes out
 * goes to both, for who opens one in the middle of a line from the next one on. Nothing waits:
 * bytes for a program that does not read them are lost, as on a wire. A browser is no program: any
 * page makes it send what it likes, so what begins like HTTP is closed, and nothing of it is read.
 */
#ifndef STEADYSTEP_SERVE_BYTE_PORT_H
#define STEADYSTEP_SERVE_BYTE_PORT_H

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <poll.h>

namespace serve
{

struct PortPlace {
    std::string link;            /* symbolic link to the pseudo-terminal; "": none */
    std::optional<unsigned> tcp; /* port on 127.0.0.1, 0: a free one */
};

class BytePort
{
  public:
    /* Throws scenario::InputError: a place that cannot be had, with the reason. */
    explicit BytePort(const PortPlace &place);
    ~BytePort();
    BytePort(const BytePort &) = delete;
    BytePort &operator=(const BytePort &) = delete;

    /* "/dev/pts/3" and "127.0.0.1:40001", as they are opened. */
    std::vector<std::string> places() const;

    /* What poll() is to wake for. */
    void watch(std::vector<pollfd> &watched) const;

    /* What has come since the last call. */
    std::string read();

    /* `more_comes`: the next call goes on with what these bytes begin. */
    void write(const std::string &bytes, bool more_comes = false);

  private:
    void open_terminal();
    bool empty_terminal() const;
    void link_terminal();
    void listen(unsigned port);
    void look_at_terminal();
    void accept_client();
    void close_client();
    std::string read_client();

    PortPlace place_;
    std::string terminal_name_;
    int terminal_ = -1, listener_ = -1, client_ = -1;
    unsigned tcp_port_ = 0;
    bool terminal_open_ = false; /* by a program */
    bool in_line_ = false;       /* what was written last is a line, and has not ended */
    bool terminal_skips_ = false, client_skips_ = false; /* the rest of it */
    bool linked_ = false;
    bool client_known_ = false;           /* for a program */
    std::string client_begin_;            /* its first bytes until then */
    std::string to_terminal_, to_client_; /* not taken yet */
};

} // namespace serve

#endif
