/* The object dictionary as an electronic data sheet, CiA 306. */
#include "sil/scenario/eds.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <vector>

#include "firmware/interface/dictionary.h"
#include "firmware/link/objects_table.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

/* Types of CiA 301. */
enum Type {
    boolean = 0x01,
    integer8 = 0x02,
    integer16 = 0x03,
    integer32 = 0x04,
    unsigned8 = 0x05,
    unsigned16 = 0x06,
    unsigned32 = 0x07,
    text_visible = 0x09,
    domain = 0x0f,
    real64 = 0x11
};

struct Object {
    std::string name;
    Type type = real64;
    const char *access = "ro";
    std::string preset, least, most; /* empty: not fixed */
    bool mapped = false;             /* may be, into a PDO */
};

/* Those of an index by their sub-indexes; one of sub-index 0 alone is a variable. */
struct Index {
    std::string name; /* of several */
    std::map<unsigned, Object> subs;
};

class Objects : public std::map<unsigned, Index>
{
  public:
    /* One without sub-indexes. */
    void put(unsigned index, const Object &object)
    {
        (*this)[index].subs[0] = object;
    }
};

/* Without an exponent, which not every reader of a sheet understands. */
std::string plain(double value)
{
    char text[400];
    const std::to_chars_result end =
        std::to_chars(text, text + sizeof text, value, std::chars_format::fixed);
    return std::string(text, end.ptr);
}

std::string fixed(double value, unsigned base)
{
    return base == SETTING_FIXED ? plain(value) : "";
}

void add_settings(Objects &objects)
{
    const Type types[] = {unsigned8, boolean, real64, integer32}; /* of enum setting_type */
    const setting *row = nullptr;
    for (std::size_t i = 0; (row = setting_number(i)) != nullptr; ++i) {
        for (unsigned n = 0; n < row->count; ++n) {
            const std::string number = row->count > 1 ? format("[%u]", n + 1) : "";
            objects.put(row->index + n,
                        {row->name + number, types[row->type], "rw",
                         setting_is_of_motor(row) ? "" : fixed(row->preset, row->preset_base),
                         fixed(row->least, row->least_base), fixed(row->most, row->most_base)});
        }
    }
}

void add_commands(Objects &objects)
{
    objects.put(0x2200, {"command", unsigned8, "wo", "", "1", std::to_string(DRIVE_COMMANDS)});
    for (int i = 0; i < DRIVE_PARAMETERS; ++i) {
        const struct parameter_row &row = *parameter_at(static_cast<drive_parameter>(i));
        objects.put(row.index, {row.name, real64, "rw", "", plain(row.least), plain(row.most)});
    }
}

void add_signals(Objects &objects)
{
    for (int i = 0; i < SIGNALS; ++i) {
        const signal_row &row = *signal_at(static_cast<drive_signal>(i));
        const Type type = i == SIGNAL_fault          ? unsigned16
                          : row.type == SIGNAL_FLAG  ? boolean
                          : row.type == SIGNAL_COUNT ? unsigned32
                          : row.type == SIGNAL_REAL  ? real64
                                                     : unsigned8;
        objects.put(row.index, {row.name, type, "ro", "", "", "", true});
    }
}

/* ---- objects_table.h ---- */

constexpr Type U8 = unsigned8, U16 = unsigned16, U32 = unsigned32, I8 = integer8, I16 = integer16,
               I32 = integer32, TEXT = text_visible, REAL64 = real64, DOMAIN = domain;

struct Access {
    const char *word;
    bool mapped, of_node;
};
constexpr Access RO = {"ro", false, false}, RO_T = {"ro", true, false},
                 RO_NODE = {"ro", false, true}, RW = {"rw", false, false},
                 RW_NODE = {"rw", false, true}, RW_R = {"rww", true, false};

struct Row {
    unsigned index, sub;
    Type type;
    Access access;
    long long preset;
    const char *name;
};

/* What objects that code answers for begin with, if that is fixed, stands in their rows. */
std::string preset_of(const Row &row)
{
    const bool follows = (row.index >= 0x6080 && row.index <= 0x6085) ||
                         (row.index >= 0x6072 && row.index <= 0x6076) ||
                         (row.index == 0x6099 && row.sub != 0) || row.index == 0x609a ||
                         (row.index == 0x2403 && row.sub == 2);
    const bool shows = row.index >= 0x6000 && row.index != 0x6061 && row.access.word == RO_T.word &&
                       row.access.mapped;
    if (row.index == 0x60e3 && row.sub != 0) {
        static const int methods[] = {LINK_HOMING_METHODS};
        return std::to_string(methods[row.sub - 1]);
    }
    if (row.type == text_visible || row.type == domain || follows || shows) {
        return "";
    }
    return row.access.of_node ? format("$NODEID+0x%llx", row.preset) : std::to_string(row.preset);
}

/* Of four alike, number n. */
std::string preset_of_pdo(const Row &row, unsigned n)
{
    static const unsigned received[] = {0, 0x60600008, 0x607a0020, 0x60ff0020};
    static const unsigned sent[] = {0, 0x60610008, 0x60640020, 0x606c0020};
    const bool is_sent = row.index >= 0x1800, maps = (row.index & 0x200) != 0;
    if (maps && row.sub == 0) {
        return n == 0 ? "1" : "2";
    }
    if (maps && row.sub == 1) {
        return is_sent ? "0x60410010" : "0x60400010";
    }
    if (maps && row.sub == 2) {
        return format("0x%08x", is_sent ? sent[n] : received[n]);
    }
    if (!maps && row.sub == 1) {
        const long long validity = (is_sent ? 0x40000000LL : 0) + (n == 0 ? 0 : 0x80000000LL);
        return format("$NODEID+0x%llx", row.preset + 0x100 * n + validity);
    }
    if (!maps && row.sub == 5 && n == 0) {
        return "100";
    }
    return preset_of(row);
}

void add_standard(Objects &objects)
{
#define ROW(index, sub, type, access, preset, name) {index, sub, type, access, preset, name},
#define STORED_ROW(index, sub, type, access, member, preset, name)                                 \
    ROW(index, sub, type, access, preset, name)
#define GROUP_NAME(index, name) {index, name},
    static const Row rows[] = {LINK_OBJECTS(STORED_ROW, ROW)};
    static const std::map<unsigned, const char *> groups = {LINK_OBJECT_GROUPS(GROUP_NAME)};
    for (const Row &row : rows) {
        const bool of_pdo = row.index >= 0x1400 && row.index < 0x1c00;
        for (unsigned n = 0; n < (of_pdo ? 4 : 1); ++n) {
            Index &index = objects[row.index + n];
            const auto group = groups.find(row.index);
            if (group != groups.end()) {
                index.name = group->second + (of_pdo ? format(" %u", n + 1) : "");
            }
            const unsigned entries = LINK_OBJECT_ENTRIES(row.index, row.sub);
            for (unsigned entry = 0; entry < entries; ++entry) {
                Row one = row;
                one.sub += entry;
                const std::string number = entries > 1 ? format(" %u", one.sub) : "";
                const std::string preset = of_pdo ? preset_of_pdo(one, n) : preset_of(one);
                index.subs[one.sub] = {row.name + number, row.type, row.access.word, preset, "", "",
                                       row.access.mapped};
            }
        }
    }
}

std::string section(const std::string &name, const Object &object)
{
    std::string text = "\n[" + name + "]\nParameterName=" + object.name +
                       "\nObjectType=" + (object.type == domain ? "0x2" : "0x7") +
                       "\nDataType=" + format("0x%04x", unsigned(object.type)) +
                       "\nAccessType=" + object.access +
                       (object.type == domain ? "\n" : "\nPDOMapping=") +
                       (object.type == domain ? ""
                        : object.mapped       ? "1\n"
                                              : "0\n");
    const auto add = [&](const char *key, const std::string &value) {
        text += value.empty() ? "" : std::string(key) + "=" + value + "\n";
    };
    add("DefaultValue", object.preset);
    add("LowLimit", object.least);
    add("HighLimit", object.most);
    return text;
}

std::string list_of(const char *name, const std::vector<unsigned> &indexes)
{
    std::string text =
        "\n[" + std::string(name) + "]\nSupportedObjects=" + std::to_string(indexes.size()) + "\n";
    for (std::size_t i = 0; i < indexes.size(); ++i) {
        text += std::to_string(i + 1) + format("=0x%04x\n", indexes[i]);
    }
    return text;
}

constexpr const char *head = R"([FileInfo]
FileName=steadystep.eds
FileVersion=1
FileRevision=0
EDSVersion=4.0
Description=Written by steadystep-sil eds from the tables of firmware/interface
CreationTime=12:00AM
CreationDate=01-01-2026
CreatedBy=steadystep-sil
ModificationTime=12:00AM
ModificationDate=01-01-2026
ModifiedBy=steadystep-sil

[DeviceInfo]
VendorName=steadystep
VendorNumber=0x00000000
ProductName=steadystep
ProductNumber=0x00000001
RevisionNumber=0x00000002
OrderCode=steadystep
BaudRate_10=1
BaudRate_20=1
BaudRate_50=1
BaudRate_125=1
BaudRate_250=1
BaudRate_500=1
BaudRate_800=1
BaudRate_1000=1
SimpleBootUpMaster=0
SimpleBootUpSlave=1
Granularity=8
DynamicChannelsSupported=0
GroupMessaging=0
NrOfRXPDO=4
NrOfTXPDO=4
LSS_Supported=0

[DummyUsage]
Dummy0001=0
Dummy0002=0
Dummy0003=0
Dummy0004=0
Dummy0005=0
Dummy0006=0
Dummy0007=0

[Comments]
Lines=2
Line1=firmware/link/README.md says how to connect.
Line2=Remote frames are not answered, whatever bit 30 of a COB-ID says.
)";

/* Of elements of one type: ARRAY; else RECORD. */
const char *type_of_several(unsigned number)
{
    static const unsigned arrays[] = {0x1003, 0x1010, 0x1011, 0x1016, 0x2401, 0x607d,
                                      0x608f, 0x6091, 0x6092, 0x6099, 0x60e3, 0x60fe};
    const bool is_array =
        std::find(std::begin(arrays), std::end(arrays), number) != std::end(arrays);
    return is_array ? "0x8" : "0x9";
}

std::string sections(unsigned number, const Index &index)
{
    const std::string name = format("%04X", number);
    if (index.name.empty()) {
        return section(name, index.subs.at(0));
    }
    std::string text = "\n[" + name + "]\nParameterName=" + index.name +
                       "\nObjectType=" + type_of_several(number) +
                       "\nSubNumber=" + std::to_string(index.subs.size()) + "\n";
    for (const auto &[sub, object] : index.subs) {
        text += section(name + format("sub%X", sub), object);
    }
    return text;
}

} // namespace

std::string electronic_data_sheet()
{
    Objects objects;
    add_standard(objects);
    add_settings(objects);
    add_commands(objects);
    add_signals(objects);

    const std::vector<unsigned> mandatory = {0x1000, 0x1001, 0x1018};
    std::vector<unsigned> standard, own;
    std::string text;
    for (const auto &[number, index] : objects) {
        if (std::find(mandatory.begin(), mandatory.end(), number) == mandatory.end()) {
            (number < 0x2000 || number >= 0x6000 ? standard : own).push_back(number);
        }
        text += sections(number, index);
    }
    return std::string(head) + list_of("MandatoryObjects", mandatory) +
           list_of("OptionalObjects", standard) + list_of("ManufacturerObjects", own) + text;
}

} // namespace scenario
