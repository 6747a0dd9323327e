#include "mba_vo/capture/device_calls.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

namespace mba_vo {
namespace {

class KernelCalls : public DeviceCalls {
 public:
  std::vector<std::string> devices() const override {
    std::vector<std::string> paths;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator("/dev", ignored)) {
      if (entry.path().filename().string().rfind("video", 0) == 0) paths.push_back(entry.path().string());
    }
    std::sort(paths.begin(), paths.end());
    return paths;
  }

  int open(const std::string& path) override {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return descriptor < 0 ? -errno : descriptor;
  }

  void close(int descriptor) override { ::close(descriptor); }

  int ioctl(int descriptor, unsigned long request, void* argument) override {
    int result = 0;
    do {
      result = ::ioctl(descriptor, request, argument);
    } while (result < 0 && errno == EINTR);
    return result < 0 ? -errno : result;
  }

  void* map(int descriptor, std::size_t length, std::size_t offset) override {
    void* memory =
        ::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, static_cast<::off_t>(offset));
    return memory == MAP_FAILED ? nullptr : memory;
  }

  void unmap(void* memory, std::size_t length) override { ::munmap(memory, length); }

  int wait(int descriptor, int milliseconds) override {
    pollfd request{descriptor, POLLIN, 0};
    const int result = ::poll(&request, 1, milliseconds);
    if (result < 0) return errno == EINTR ? 0 : -errno;
    return result;
  }
};

}  // namespace

std::shared_ptr<DeviceCalls> kernelCalls() { return std::make_shared<KernelCalls>(); }

}  // namespace mba_vo
