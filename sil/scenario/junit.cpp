#include "sil/scenario/junit.h"

#include "sil/scenario/output.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

/* As an attribute or a text. */
std::string escaped(const std::string &text)
{
    std::string xml;
    for (const char letter : in_one_line(text)) {
        switch (letter) {
        case '&':
            xml += "&amp;";
            break;
        case '<':
            xml += "&lt;";
            break;
        case '>':
            xml += "&gt;";
            break;
        case '"':
            xml += "&quot;";
            break;
        default:
            xml += letter;
        }
    }
    return xml;
}

std::string failure(const char *type, const std::string &message)
{
    return std::string("      <failure type=\"") + type + "\" message=\"" + escaped(message) +
           "\"/>\n";
}

std::string failures(const Result &result, const std::vector<bool> &bound_holds)
{
    std::string xml;
    const std::string other = result.not_as_described();
    if (!other.empty()) {
        xml += failure("run", other);
    }
    if (const Incident *const fault = result.unexpected_fault()) {
        xml += failure("fault", fault->text());
    }
    const std::vector<Expectation> &expectations = result.scenario->expectations;
    for (std::size_t i = 0; i < expectations.size(); ++i) {
        const Observation &observed = result.observations[i];
        if (bound_holds[i] || observed.held || !result.failure.empty()) {
            continue;
        }
        const Expectation &expected = expectations[i];
        const std::string value = expected.of_fault() ? observed.text : readable(observed.value);
        xml += failure("bound", expected.metric + " in " + expected.window.name() + ": " + value +
                                    ", expected " + expected.bound());
    }
    return xml;
}

std::string suite(const std::vector<Result> &results, std::size_t &failed)
{
    const Scenario &scenario = *results.front().scenario;
    std::vector<bool> bound_holds;
    for (std::size_t i = 0; i < scenario.expectations.size(); ++i) {
        bound_holds.push_back(judge(scenario.expectations[i], i, results).held);
    }
    std::string cases;
    double cpu_s = 0;
    std::size_t of_suite = 0;
    for (const Result &result : results) {
        const std::string what = failures(result, bound_holds);
        const std::string command =
            escaped(reproduce_command(scenario, result.numeric, result.seed));
        cases += "    <testcase classname=\"" + escaped(scenario.name) + "\" name=\"" +
                 result.numeric + " seed " + std::to_string(result.seed) +
                 format("\" time=\"%.3f\">\n", result.cpu_s) + what + "      <system-out>" +
                 command + "</system-out>\n    </testcase>\n";
        of_suite += what.empty() ? 0 : 1;
        cpu_s += result.cpu_s;
    }
    failed += of_suite;
    return "  <testsuite name=\"" + escaped(scenario.name) +
           format("\" tests=\"%zu\" failures=\"%zu\" errors=\"0\" time=\"%.3f\">\n", results.size(),
                  of_suite, cpu_s) +
           cases + "  </testsuite>\n";
}

} // namespace

std::string junit_xml(const std::vector<std::vector<Result>> &scenarios)
{
    std::string suites;
    std::size_t tests = 0, failed = 0;
    for (const std::vector<Result> &results : scenarios) {
        suites += suite(results, failed);
        tests += results.size();
    }
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" +
           format("<testsuites name=\"steadystep-sil\" tests=\"%zu\" failures=\"%zu\" "
                  "errors=\"0\">\n",
                  tests, failed) +
           suites + "</testsuites>\n";
}

} // namespace scenario
