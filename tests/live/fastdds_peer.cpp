// A robot, or one who listens to it, on eProsima Fast DDS: an implementation of DDS that is not ours.
//
//   fastdds_peer publish DOMAIN FILE        replays a file of serialised messages, and stays
//   fastdds_peer listen DOMAIN TOPIC TYPE LATCHED ...   says what comes, until it is killed
//
// A file has for each topic its name, its type, and L (latched), R (reliable) or B (best effort); then the
// messages with the number of their topic and the time after the start. Latched messages are sent at once, the
// others after each topic was subscribed to, and the latched ones were received. Everything stays on the loopback
// interface.

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

using namespace eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using Bytes = std::vector<uint8_t>;

constexpr uint32_t MOST_BYTES = 4'000'000;  // of a message
constexpr int MOST_PARTICIPANTS = 20;       // of this machine, in one domain
constexpr int LEASE_S = 3;                  // after which a killed participant is gone

// A type of any name, whose samples are serialised messages.
class RawType : public TopicDataType {
public:
    explicit RawType(const std::string& name) {
        setName(name.c_str());
        m_typeSize = MOST_BYTES;
        m_isGetKeyDefined = false;
    }
    bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
        const auto& bytes = *static_cast<Bytes*>(data);
        if (bytes.size() > payload->max_size) return false;
        payload->encapsulation = CDR_LE;
        payload->length = static_cast<uint32_t>(bytes.size());
        std::memcpy(payload->data, bytes.data(), bytes.size());
        return true;
    }
    bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
        static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
        return true;
    }
    std::function<uint32_t()> getSerializedSizeProvider(void* data) override {
        return [data] { return static_cast<uint32_t>(static_cast<Bytes*>(data)->size()); };
    }
    void* createData() override { return new Bytes(); }
    void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
    bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

DomainParticipant* join(uint32_t domain) {
    DomainParticipantQos qos = PARTICIPANT_QOS_DEFAULT;
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.push_back("127.0.0.1");
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    auto& discovery = qos.wire_protocol().builtin;
    for (int i = 0; i < MOST_PARTICIPANTS; ++i) {
        rtps::Locator_t peer;
        rtps::IPLocator::setIPv4(peer, "127.0.0.1");
        peer.port = 7400 + 250 * domain + 10 + 2 * i;  // the ports that the standard gives to participants
        discovery.initialPeersList.push_back(peer);
    }
    discovery.discovery_config.leaseDuration = eprosima::fastrtps::Duration_t(LEASE_S, 0);
    discovery.discovery_config.leaseDuration_announcementperiod = eprosima::fastrtps::Duration_t(1, 0);
    auto* participant = DomainParticipantFactory::get_instance()->create_participant(domain, qos);
    if (participant == nullptr) {
        std::cerr << "no participant of domain " << domain << std::endl;
        std::exit(1);
    }
    return participant;
}

Topic* topic_of(DomainParticipant* participant, const std::string& name, const std::string& type) {
    TypeSupport(new RawType(type)).register_type(participant);
    return participant->create_topic(name, type, TOPIC_QOS_DEFAULT);
}

template <class Qos>
void set_quality(Qos& qos, char kind, int depth) {
    qos.reliability().kind = kind == 'B' ? BEST_EFFORT_RELIABILITY_QOS : RELIABLE_RELIABILITY_QOS;
    qos.durability().kind = kind == 'L' ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
    qos.history().kind = KEEP_LAST_HISTORY_QOS;
    qos.history().depth = depth;
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
}

template <class T>
T value(std::istream& file) {
    T read{};
    file.read(reinterpret_cast<char*>(&read), sizeof read);
    return read;
}

Bytes block(std::istream& file) {
    Bytes bytes(value<uint32_t>(file));
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return bytes;
}

std::string text(std::istream& file) {
    const Bytes bytes = block(file);
    return {bytes.begin(), bytes.end()};
}

struct Writer {
    DataWriter* writer;
    bool is_latched;
};

bool is_heard(const Writer& one) {
    PublicationMatchedStatus status;
    one.writer->get_publication_matched_status(status);
    return status.current_count > 0;
}

int publish(uint32_t domain, const char* path) {
    std::ifstream file(path, std::ios::binary);
    auto* participant = join(domain);
    auto* publisher = participant->create_publisher(PUBLISHER_QOS_DEFAULT);
    std::vector<Writer> writers;
    for (auto topics = value<uint32_t>(file); topics > 0; --topics) {
        const std::string name = text(file), type = text(file), kind = text(file), told = text(file);
        DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
        set_quality(qos, kind[0], 1000);
        qos.user_data().setValue(std::vector<rtps::octet>(told.begin(), told.end()));
        qos.publish_mode().kind = SYNCHRONOUS_PUBLISH_MODE;
        writers.push_back({publisher->create_datawriter(topic_of(participant, name, type), qos), kind[0] == 'L'});
    }
    std::cout << "listening " << domain << std::endl;
    bool is_paced = false;
    std::chrono::steady_clock::time_point start;
    while (file.peek() != EOF) {
        const auto& to = writers.at(value<uint32_t>(file));
        const auto after = std::chrono::nanoseconds(value<int64_t>(file));
        Bytes bytes = block(file);
        if (!to.is_latched && !is_paced) {
            for (const auto& one : writers) {
                while (!is_heard(one)) std::this_thread::sleep_for(std::chrono::milliseconds(5));
                if (one.is_latched) one.writer->wait_for_acknowledgments({60, 0});
            }
            is_paced = true;
            start = std::chrono::steady_clock::now();
        }
        if (is_paced) std::this_thread::sleep_until(start + after);
        if (!to.writer->write(&bytes)) std::cerr << "not sent" << std::endl;
    }
    std::cout << "sent" << std::endl;
    for (std::string line; std::getline(std::cin, line);) {
    }
    participant->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant);
    return 0;
}

// Says the topic of each message and the message in hexadecimal digits.
class Teller : public DataReaderListener {
public:
    void on_data_available(DataReader* reader) override {
        Bytes bytes;
        SampleInfo info;
        while (reader->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK) {
            if (!info.valid_data) continue;
            std::string line = reader->get_topicdescription()->get_name() + " ";
            static const char digits[] = "0123456789abcdef";
            for (const auto byte : bytes) line += {digits[byte >> 4], digits[byte & 15]};
            const std::lock_guard<std::mutex> guard(mutex);
            std::cout << line << std::endl;
        }
    }

private:
    std::mutex mutex;
};

int listen(uint32_t domain, char** words, int count) {
    auto* participant = join(domain);
    auto* subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
    Teller teller;
    for (int i = 0; i + 2 < count; i += 3) {
        DataReaderQos qos = DATAREADER_QOS_DEFAULT;
        set_quality(qos, words[i + 2][0], 100);
        subscriber->create_datareader(topic_of(participant, words[i], words[i + 1]), qos, &teller);
    }
    std::cout << "listening " << domain << std::endl;
    for (std::string line; std::getline(std::cin, line);) {
    }
    participant->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant);
    return 0;
}

int main(int count, char** words) {
    if (count < 4) return 2;
    const auto domain = static_cast<uint32_t>(std::stoul(words[2]));
    return std::string(words[1]) == "publish" ? publish(domain, words[3]) : listen(domain, words + 3, count - 3);
}
