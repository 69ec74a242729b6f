#include "sil/serve/can_adapter.h"

extern "C" {
#include "firmware/link/slcan.h"
}

namespace serve
{

std::string CanAdapter::take(const std::string &bytes,
                             const std::function<bool(const can_frame &)> &send)
{
    std::string answers;
    for (const char byte : bytes) {
        if (byte == '\r') {
            answers += answer(send);
            line_.clear();
        } else if (byte != '\n' && line_.size() <= SLCAN_LINE_BYTES) {
            line_ += byte;
        }
    }
    return answers;
}

std::string CanAdapter::answer(const std::function<bool(const can_frame &)> &send)
{
    can_frame frame = {};
    if (line_.empty()) {
        return "";
    }
    const slcan_meaning meaning = slcan_read(line_.data(), line_.size(), &frame);
    switch (meaning) {
    case SLCAN_OPENS:
    case SLCAN_LISTENS:
        open_ = true;
        listens_only_ = meaning == SLCAN_LISTENS;
        break;
    case SLCAN_CLOSES:
        open_ = false;
        break;
    case SLCAN_SENDS:
        return slcan_answer(meaning, open_ && !listens_only_ && send(frame));
    default:
        break;
    }
    return slcan_answer(meaning, open_);
}

std::string CanAdapter::show(const can_frame &frame) const
{
    char text[SLCAN_FRAME_BYTES];
    return open_ ? std::string(text, slcan_write(&frame, text)) : "";
}

} // namespace serve
