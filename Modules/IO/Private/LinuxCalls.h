// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_LinuxCalls_h
#define mammoray_Private_LinuxCalls_h

#include <cstdint>
#include <cstdio>
#include <filesystem>

namespace mammoray
{
/// What this module asks of Linux and of no other system; everything else is POSIX.
namespace linuxCalls
{
/// Opens a file in memory, closed in other programs; below 0 if it cannot (errno).
int OpenInMemory(const char* name);

/// The path by which this process opens an open file or folder again.
std::filesystem::path PathOf(int descriptor);

/// Whether another file system begins at the folder.
bool IsMountPoint(const std::filesystem::path& folder);

/// Exchanges two files or folders in one step; false if it cannot (errno).
bool Exchange(const std::filesystem::path& one, const std::filesystem::path& other);

/// Kills this process when its parent ends.
void EndWithParent();

/// Addresses of this process, bytes.
std::uint64_t AddressesInUse();

/// Drops what is buffered and not written yet.
void Purge(std::FILE* file);
}
}

#endif
