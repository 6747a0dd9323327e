#pragma once

#include "mba_vo/io/offline_run.h"

/// One line of what became of the images. Throws std::runtime_error if none could be tracked.
void printCounts(const mba_vo::OfflineResult& result);

/// What was learnt about the camera, with which the run begins anew.
void printLearnt(const mba_vo::OfflineResult& result);
