#pragma once

#include <cstdint>
#include <vector>

#include "auv_common/time.hpp"

namespace stg {

/// Decides which parties a step waits for: each present party answers or is given up.
///
/// One step is open at a time; its stamp (simulated time) identifies it. A party is present or
/// absent, and steps wait only for present ones. Only the first answer of a party to the open step
/// counts. A party that has sent nothing by its deadline becomes absent. No step waits for it until
/// it sends a message again. A message about another recent step makes it present, too, but does
/// not answer the open step.
///
/// Every wait ends. A party that has sent nothing since it was first asked keeps the deadline of
/// that step, however many steps are opened, replaced or closed in the meantime. Its silence does
/// not shorten the time that other parties have.
///
/// Deadlines are wall time in seconds. The caller chooses the clock; it must not go back. This
/// class reads no clock. Parties that only listen do not belong here, because no step waits for
/// them (see StepWindow). Nothing is allocated after construction. Not thread-safe.
class StepBarrier {
 public:
  /// A message whose stamp differs from the present step by this or more is no evidence that a
  /// party runs [ns]. If steps are long, the limit is three steps, because a party may be two steps
  /// ahead.
  static constexpr TimeNs kRecent = 10'000'000'000;

  enum class Opening {
    kOpened,
    kReplaced,  ///< opened; the step that was open is dropped without an end, and no party missed
                ///< it
    kRepeated,  ///< this step is open already, or was the last one closed: nothing changes
  };

  /// Meaning of a message of a party.
  enum class Word {
    kCounts,     ///< the answer to the open step
    kDuplicate,  ///< the party has answered this step already
    kLate,       ///< about an earlier step, or about the last one after it was closed
    kEarly,  ///< about a later step: the caller keeps the message and repeats it when that step is
             ///< open
    kForeign,  ///< about a time that is not of this run; it does not show that the party is present
  };

  /// All parties are present at first.
  /// @param parties at least 0.
  /// @param period of the steps [ns], at least 0; 0: short compared with kRecent.
  explicit StepBarrier(int parties, TimeNs period = 0);

  /// Opens a step. Stamps may come in any order: a party stays present even if the clock goes back.
  /// @param deadline_s end of the wait for answers; infinity: wait forever.
  Opening Open(TimeNs stamp, double deadline_s);

  /// Handles a message of a party about the step at `stamp`.
  Word Hear(int party, TimeNs stamp);

  /// Excuses a party from the open step: the step does not wait for it, and counts no miss. This
  /// does not show that the party is present. An answer that it owed before is still owed.
  void Excuse(int party);

  /// Marks the parties that are out of time as absent. Returns them; the list is valid until the
  /// next call.
  const std::vector<int>& GiveUp(double now_s);

  /// True if a step is open, and each present party of [first, last) has answered or is excused.
  bool Complete() const { return Complete(0, parties()); }
  bool Complete(int first, int last) const;

  /// Ends the open step. A party without an answer, present or absent, has missed it.
  void Close();

  /// Moves the deadline of all parties to `deadline_s`; used after a pause.
  void Extend(double deadline_s);

  /// Resets everything except the counters, because another run begins.
  void Restart();

  int parties() const { return static_cast<int>(parties_.size()); }
  bool open() const { return open_; }
  /// True if a step has been closed: every party of the run has had the time to start.
  bool started() const { return started_; }
  /// Stamp of the open step or, if none is open, of the last one; meaningless before the first.
  TimeNs stamp() const { return stamp_; }
  /// The earliest deadline of the parties that the step waits for; infinity: it waits for none.
  double deadline_s() const;

  bool present(int party) const { return At(party).present; }
  /// True if the party has answered the open step or, if none is open, the last one.
  bool answered(int party) const { return At(party).answered; }
  /// Number of steps that were closed without its answer.
  std::uint64_t misses(int party) const { return At(party).misses; }
  /// Number of times that it was given up.
  std::uint64_t losses(int party) const { return At(party).losses; }

 private:
  struct Party {
    bool present = true;
    bool answered = false;
    bool excused = false;
    bool owes = false;        ///< it was asked and has sent nothing since
    bool owed = false;        ///< the value of `owes` before the open step
    double deadline_s = 0.0;  ///< counts only if the step waits for it
    std::uint64_t misses = 0, losses = 0;
  };

  Party& At(int party);
  const Party& At(int party) const;
  bool WaitsFor(const Party& party) const;

  TimeNs recent_;
  bool open_ = false, started_ = false;
  bool has_stamp_ = false;
  TimeNs stamp_ = 0;
  double deadline_s_ = 0.0;  ///< deadline of the open step
  std::vector<Party> parties_;
  std::vector<int> given_up_;
};

}  // namespace stg
