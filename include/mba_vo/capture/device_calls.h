#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace mba_vo {

/// The system calls by which Video4Linux is spoken to: a seam, so that tests can play a device. What fails returns
/// -errno.
class DeviceCalls {
 public:
  virtual ~DeviceCalls() = default;
  /// Paths of all video devices.
  virtual std::vector<std::string> devices() const = 0;
  /// A descriptor that does not block.
  virtual int open(const std::string& path) = 0;
  virtual void close(int descriptor) = 0;
  virtual int ioctl(int descriptor, unsigned long request, void* argument) = 0;
  /// nullptr if it fails.
  virtual void* map(int descriptor, std::size_t length, std::size_t offset) = 0;
  virtual void unmap(void* memory, std::size_t length) = 0;
  /// 1: something can be read, or there is an error to be told; 0: not within this time.
  virtual int wait(int descriptor, int milliseconds) = 0;
};

std::shared_ptr<DeviceCalls> kernelCalls();

}  // namespace mba_vo
