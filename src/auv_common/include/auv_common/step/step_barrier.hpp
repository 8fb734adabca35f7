#pragma once

#include <cstdint>
#include <vector>

#include "auv_common/time.hpp"

namespace stg {

/// Which parties a step waits for: each party that is present answers, or is given up.
///
/// One step is open at a time, known by its stamp (simulated time). A party is present, and waited
/// for, or absent. The first answer of a party to the open step counts. A party that has not spoken
/// by its deadline is absent, and no step waits for it before it speaks again; a word about another
/// recent step is enough for that, but is no answer to this one.
///
/// Waiting always has an end: a party that has not spoken since it was first asked keeps the
/// deadline of that step, however many steps are opened, left or closed meanwhile. Its silence
/// costs no other party's patience.
///
/// Deadlines are wall time in seconds of a clock of the caller's choice that does not go back. This
/// class reads no clock. Parties that only listen have no place here: no step waits for them (see
/// StepWindow). Nothing is allocated after construction. Not thread-safe.
class StepBarrier {
 public:
  /// Words about steps at least this far from the present one prove nothing [ns]. Where steps are
  /// long it is three of them: the next but one may be spoken of before the next is opened.
  static constexpr TimeNs kRecent = 10'000'000'000;

  enum class Opening {
    kOpened,
    kReplaced,  ///< opened, and the step that was open is left without an end: no party missed it
    kRepeated,  ///< this very step is open or was the last one closed: nothing has changed
  };

  /// What a party's word is worth.
  enum class Word {
    kCounts,     ///< the answer to the open step
    kDuplicate,  ///< the party has answered this step before
    kLate,       ///< about an earlier step, or about the last one after it was closed
    kEarly,      ///< about a later step: keep it and say it again when that step is open
    kForeign,    ///< about a time that is not of this run: no sign of presence either
  };

  /// All parties are present.
  /// @param parties at least 0.
  /// @param period of the steps [ns], at least 0; 0: short beside kRecent.
  explicit StepBarrier(int parties, TimeNs period = 0);

  /// Opens a step. Any order of stamps is allowed: presence outlives a clock that goes back.
  /// @param deadline_s until when answers are waited for; infinity: for ever.
  Opening Open(TimeNs stamp, double deadline_s);

  /// Takes a party's word about the step at `stamp`.
  Word Hear(int party, TimeNs stamp);

  /// Asks nothing of a party in the open step: not waited for, no miss, no sign of presence. What
  /// it owed before it goes on owing.
  void Excuse(int party);

  /// Marks the parties absent that are out of time, and returns them: valid until the next call.
  const std::vector<int>& GiveUp(double now_s);

  /// A step is open, and each party of [first, last) that is present has answered or is excused.
  bool Complete() const { return Complete(0, parties()); }
  bool Complete(int first, int last) const;

  /// Ends the open step: a party that has not answered, present or not, has missed it.
  void Close();

  /// Gives all parties until `deadline_s`: after a pause.
  void Extend(double deadline_s);

  /// As new, but for the counters: another run begins.
  void Restart();

  int parties() const { return static_cast<int>(parties_.size()); }
  bool open() const { return open_; }
  /// A step has been closed: every party of the run has had the time to start.
  bool started() const { return started_; }
  /// Of the step that is open or was the last one; meaningless before the first.
  TimeNs stamp() const { return stamp_; }
  /// The earliest deadline of the parties that the step waits for; infinity: there are none.
  double deadline_s() const;

  bool present(int party) const { return At(party).present; }
  /// Has answered the step that is open or was the last one.
  bool answered(int party) const { return At(party).answered; }
  /// Steps that were closed without its answer.
  std::uint64_t misses(int party) const { return At(party).misses; }
  /// How often it was given up.
  std::uint64_t losses(int party) const { return At(party).losses; }

 private:
  struct Party {
    bool present = true;
    bool answered = false;
    bool excused = false;
    bool owes = false;        ///< was asked and has not said a word since
    bool owed = false;        ///< the same before the open step
    double deadline_s = 0.0;  ///< if it is waited for
    std::uint64_t misses = 0, losses = 0;
  };

  Party& At(int party);
  const Party& At(int party) const;
  bool WaitsFor(const Party& party) const;

  TimeNs recent_;
  bool open_ = false, started_ = false;
  bool has_stamp_ = false;
  TimeNs stamp_ = 0;
  double deadline_s_ = 0.0;  ///< of the open step
  std::vector<Party> parties_;
  std::vector<int> given_up_;
};

}  // namespace stg
