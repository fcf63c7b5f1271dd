#include "drivers/transport/can_socket.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace slamd::transport {

namespace {

constexpr can_err_mask_t kErrors = CAN_ERR_CRTL | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;
/// Of an error frame's data: what the controller has to say.
constexpr std::size_t kController = 1;

[[noreturn]] void fail(const std::string& interface, int error) {
  const std::string words = std::generic_category().message(error);
  switch (error) {
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT:
      throw TransportError("CAN interface " + interface + ": this kernel has no CAN (" + words + "; modprobe can-raw, where it is a module)");
    case EPERM:
    case EACCES: throw TransportError("CAN interface " + interface + ": no permission for a CAN socket (" + words + ")");
    default: throw TransportError("CAN interface " + interface + ": " + words);
  }
}

can_filter as_kernel_has_it(const CanFilter& filter) {
  // The flags belong to the mask, too: a short id is not the beginning of a long one, nor a request an answer.
  return {filter.id | (filter.is_extended ? CAN_EFF_FLAG : 0U), filter.mask | CAN_EFF_FLAG | CAN_RTR_FLAG};
}

}  // namespace

const char* in_words(CanLink link) {
  switch (link) {
    case CanLink::kUnknown: return "not looked for yet";
    case CanLink::kAbsent: return "no such interface; it is looked for";
    case CanLink::kNotCan: return "is no CAN interface";
    case CanLink::kDown: return "is down (ip link set up brings it up)";
    case CanLink::kUp: return "is up";
  }
  return "?";
}

/// The memory that recvmmsg fills.
struct CanSocket::Batch {
  struct Slot {
    can_frame frame;
    alignas(cmsghdr) std::array<std::byte, Receipts::kControlBytes> control;
    iovec part;
  };

  Batch() {
    for (Slot& slot : slots) {
      slot.part = {&slot.frame, sizeof slot.frame};
    }
  }

  /// Undoes what the last call has written into the headers.
  void rearm() {
    for (std::size_t i = 0; i < kBatch; ++i) {
      msghdr& header = messages[i].msg_hdr;
      header = {};
      header.msg_iov = &slots[i].part;
      header.msg_iovlen = 1;
      header.msg_control = slots[i].control.data();
      header.msg_controllen = slots[i].control.size();
    }
  }

  std::array<Slot, kBatch> slots{};
  std::array<mmsghdr, kBatch> messages{};
};

CanSocket::CanSocket(const CanSocketConfig& config, const HostClock& clock)
    : interface_(config.interface),
      filters_(config.filters),
      receipts_(clock),
      batch_(std::make_unique<Batch>()) {
  try {
    open_socket(config.receive_buffer_bytes);
  } catch (...) {
    close(fd_);
    throw;
  }
}

CanSocket::CanSocket(int fd, std::string interface, const HostClock& clock)
    : interface_(std::move(interface)), receipts_(clock), fd_(fd), batch_(std::make_unique<Batch>()) {
  receipts_.set_up(fd_, CanSocketConfig{}.receive_buffer_bytes);
}

CanSocket::~CanSocket() { close(fd_); }

void CanSocket::open_socket(int receive_buffer_bytes) {
  fd_ = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (fd_ < 0) {
    fail(interface_, errno);
  }
  if (const int error = receipts_.set_up(fd_, receive_buffer_bytes); error != 0) {
    fail(interface_, error);
  }
  if (!set_filters() || setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &kErrors, sizeof kErrors) != 0) {
    fail(interface_, errno);
  }
}

bool CanSocket::set_filters() const {
  std::vector<can_filter> filters;
  for (const CanFilter& filter : filters_) {
    filters.push_back(as_kernel_has_it(filter));
  }
  if (filters.empty()) {
    filters.push_back({0, 0});  // all
  }
  return setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(), static_cast<socklen_t>(filters.size() * sizeof(can_filter))) == 0;
}

CanLink CanSocket::attend() {
  ifreq request{};
  interface_.copy(request.ifr_name, IFNAMSIZ - 1);
  CanLink link = CanLink::kAbsent;
  if (ioctl(fd_, SIOCGIFINDEX, &request) != 0) {
    index_.store(0, std::memory_order_relaxed);
  } else if (request.ifr_ifindex != interface_index() && !bind_to(request.ifr_ifindex)) {
    link = CanLink::kNotCan;
  } else if (ioctl(fd_, SIOCGIFFLAGS, &request) == 0) {
    link = (request.ifr_flags & IFF_UP) != 0 ? CanLink::kUp : CanLink::kDown;
  }
  link_.store(link, std::memory_order_relaxed);
  return link;
}

bool CanSocket::bind_to(int index) {
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = index;
  // With an interface that is gone the kernel has forgotten the filters, too.
  if (!set_filters() || bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return false;
  }
  index_.store(index, std::memory_order_relaxed);
  return true;
}

std::size_t CanSocket::take_batch() {
  batch_->rearm();
  // That the interface went down or away is an error, once; whoever attends sees for himself.
  return receipts_.receive(fd_, batch_->messages);
}

bool CanSocket::open(std::size_t index, CanFrame& frame) {
  const can_frame& raw = batch_->slots[index].frame;
  mmsghdr& message = batch_->messages[index];
  frame.received = receipts_.read(message.msg_hdr);
  if (message.msg_len != sizeof raw || (message.msg_hdr.msg_flags & MSG_TRUNC) != 0 || raw.can_dlc > CAN_MAX_DLEN) {
    other_.add();
    return false;
  }
  const std::span<const std::byte> data = std::as_bytes(std::span(raw.data)).first(raw.can_dlc);
  if ((raw.can_id & CAN_ERR_FLAG) != 0) {
    note_error(raw.can_id, data);
    return false;
  }
  if ((raw.can_id & CAN_RTR_FLAG) != 0) {
    other_.add();
    return false;
  }
  frame.is_extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.id = raw.can_id & (frame.is_extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.size = raw.can_dlc;
  std::copy(data.begin(), data.end(), frame.data.begin());
  received_.add();
  return true;
}

void CanSocket::note_error(std::uint32_t id, std::span<const std::byte> data) {
  const auto controller =
      (id & CAN_ERR_CRTL) != 0 && data.size() > kController ? std::to_integer<unsigned>(data[kController]) : 0U;
  const auto count_if = [](bool is_so, Counter& counter) {
    if (is_so) {
      counter.add();
    }
  };
  count_if((id & CAN_ERR_BUSOFF) != 0, bus_off_);
  count_if((id & CAN_ERR_RESTARTED) != 0, restarted_);
  count_if((controller & CAN_ERR_CRTL_RX_OVERFLOW) != 0, controller_lost_);
  count_if((controller & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0, warnings_);
  count_if((controller & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0, passive_);
}

std::string CanSocket::buffer_remark() const { return receipts_.buffer_remark("CAN interface " + interface_); }

CanCounters CanSocket::counters() const {
  return {received_.value(),  other_.value(),     receipts_.lost(),  controller_lost_.value(),
          bus_off_.value(),   restarted_.value(), warnings_.value(), passive_.value()};
}

}  // namespace slamd::transport
