#include "sil/virtual_board/register_lessons.h"

#include <utility>

namespace virtual_board
{

void RegisterLessons::begin(AddressRange block)
{
    block_ = block;
    noted_.clear();
}

void RegisterLessons::note(const RegisterAccess &access)
{
    if (running()) {
        noted_.push_back(access);
    }
}

void RegisterLessons::abandon()
{
    block_ = {0, 0};
}

AddressRange RegisterLessons::finish()
{
    lessons_[block_.base] = {block_.bytes, std::move(noted_)};
    noted_.clear();
    return std::exchange(block_, {0, 0});
}

const std::vector<RegisterAccess> *RegisterLessons::known(AddressRange block) const
{
    const auto found = lessons_.find(block.base);
    const bool known = found != lessons_.end() && found->second.bytes == block.bytes;
    return known ? &found->second.accesses : nullptr;
}

void RegisterLessons::refute(std::uint32_t block)
{
    lessons_[block] = {};
}

bool RegisterLessons::refuted(std::uint32_t block) const
{
    const auto found = lessons_.find(block);
    return found != lessons_.end() && found->second.bytes == 0;
}

} // namespace virtual_board
