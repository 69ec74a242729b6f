/*
 * DMA1, DMA2 and the DMAMUX. A request moves one item at once; the time of a transfer on the bus
 * is not modelled. Reference: RM0440, chapters DMA and DMAMUX.
 */
#ifndef STEADYSTEP_VIRTUAL_BOARD_DMA_H
#define STEADYSTEP_VIRTUAL_BOARD_DMA_H

#include <array>
#include <map>

#include "sil/virtual_board/peripherals/register_block.h"

namespace virtual_board
{

/* Request numbers of the DMAMUX. */
enum class DmaRequest : unsigned {
    adc1 = 5,
    lpuart1_rx = 34,
    lpuart1_tx = 35,
    adc2 = 36,
    adc3 = 37,
    adc4 = 38,
    adc5 = 39
};

class Dma : public RegisterBlock
{
  public:
    static constexpr unsigned channels = 8;

    Dma(Chip &chip, unsigned number); /* 1 or 2 */

    void reset() override;

    bool enabled(unsigned channel) const;
    /* One item; false if the channel takes none. The memory address it used goes to `where`. */
    bool transfer(unsigned channel, std::uint32_t *where);
    class Ring;
    /* Whether a channel fetches from one register for ever and raises no interrupt: only its
       registers show how far it is. */
    bool silent(unsigned channel) const;
    /* Rises with every write that may change what a channel does. */
    unsigned changes() const
    {
        return changes_;
    }

    std::function<void(unsigned channel)> on_enable;

  protected:
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    static constexpr std::uint32_t whole_flag = 2, half_flag = 4; /* TCIF, HTIF */

    std::uint32_t memory_address(unsigned channel) const;
    void count_item(unsigned channel);
    void flag(unsigned channel, std::uint32_t flags);
    void interrupt(unsigned channel);
    void interrupts();

    unsigned number_;
    unsigned changes_ = 0;
    std::array<std::uint32_t, channels> loaded_{}; /* items when the channel was enabled */
};

/* A silent channel that is known to read the register of a peripheral, which passes on what that
   holds, many items at once. The channel's registers show them when this is gone. */
class Dma::Ring
{
  public:
    Ring(Dma &dma, unsigned channel);
    ~Ring();
    Ring(const Ring &) = delete;
    Ring &operator=(const Ring &) = delete;

    /* Returns the memory address. */
    std::uint32_t put(std::uint32_t data)
    {
        const std::uint32_t offset = (items_ - left_) * step_;
        left_--;
        flags_ |= left_ == items_ / 2 ? half_flag : 0u;
        if (left_ == 0) {
            flags_ |= whole_flag;
            left_ = items_;
        }
        if (host_ != nullptr) {
            host_[offset] = static_cast<std::uint8_t>(data);
            host_[offset + 1] = static_cast<std::uint8_t>(data >> 8);
        } else {
            dma_.chip_.store(address_ + offset, bytes_, data & mask_);
        }
        return address_ + offset;
    }

  private:
    Dma &dma_;
    unsigned channel_;
    std::uint32_t address_, items_, left_;
    unsigned bytes_;
    std::uint32_t step_, mask_;
    std::uint32_t flags_ = 0;
    std::uint8_t *host_ = nullptr; /* memory of 16-bit items, if it is plain */
};

class Dmamux : public RegisterBlock
{
  public:
    Dmamux(Chip &chip, Dma &dma1, Dma &dma2);

    /* A peripheral asks for one item; false if no enabled channel is routed to it. */
    bool request(DmaRequest source, std::uint32_t *where = nullptr);
    /* The enabled channel that a request is routed to; no `dma`: there is none. */
    struct Route {
        Dma *dma = nullptr;
        unsigned channel = 0;
    };
    Route route(DmaRequest source) const;
    /* Rises with every write that may change a route or what a channel does. */
    unsigned changes() const
    {
        return changes_ + dma1_.changes() + dma2_.changes();
    }
    void reset() override;
    /* Called when a channel that is routed to the request has been enabled. */
    void on_ready(DmaRequest source, std::function<void()> poll)
    {
        polls_[source] = std::move(poll);
    }

  protected:
    void put(std::uint32_t offset, std::uint32_t value, Master master) override;

  private:
    void enabled(unsigned index);

    Dma &dma1_, &dma2_;
    unsigned changes_ = 0;
    std::map<DmaRequest, std::function<void()>> polls_;
    std::vector<DmaRequest> ready_;
    Event poll_event_;
};

} // namespace virtual_board

#endif
