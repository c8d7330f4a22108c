#include "diagnosis/screening.hpp"

#include <algorithm>
#include <map>

#include <Eigen/QR>

#include "poecal/core/parallel.hpp"

namespace poecal {
namespace {

// Rows of a block: its whitened columns stay in a core's cache while every candidate passes over them.
constexpr int kBlockRows = 128;
// Columns that are multiplied at a time.
constexpr Eigen::Index kChunkColumns = 48;

/// Some poses that follow each other.
struct Block {
  std::size_t begin = 0, end = 0;                          ///< groups
  std::size_t observation_begin = 0, observation_end = 0;  ///< of them
  int row = 0, rows = 0;                                   ///< where they begin, and how many
};

std::vector<Block> blocksOf(const CaptureRows& rows) {
  std::vector<Block> blocks;
  for (std::size_t g = 0; g < rows.groups.size(); ++g) {
    const ObservationRows& first = rows.observations[rows.groups[g].front()];
    const ObservationRows& last = rows.observations[rows.groups[g].back()];
    if (blocks.empty() || blocks.back().rows >= kBlockRows) blocks.push_back({g, g, rows.groups[g].front(), 0, first.begin, 0});
    Block& block = blocks.back();
    block.end = g + 1;
    block.observation_end = rows.groups[g].back() + 1;
    block.rows = last.begin + last.size - block.row;
  }
  return blocks;
}

/// Whitened rows of a block, with what the linearisation has already.
struct WhiteBlock {
  Eigen::MatrixXd X;
  Eigen::VectorXd residual;  ///< L^-1 (r - X b)
};

WhiteBlock whiten(const Linearised& linear, const Whitening& whitening, const Block& block) {
  const CaptureRows& rows = linear.rows;
  Eigen::MatrixXd all(block.rows, rows.J.cols() + linear.columns.cols() + 1);
  all << rows.J.middleRows(block.row, block.rows), linear.columns.middleRows(block.row, block.rows), rows.r.segment(block.row, block.rows);
  for (std::size_t g = block.begin; g < block.end; ++g) {
    auto of_pose = all.middleRows(whitening.begin(g) - block.row, whitening.size(g));
    of_pose = whitening.applyTo(g, of_pose);
  }
  WhiteBlock white{all.leftCols(all.cols() - 1), {}};
  white.residual = all.rightCols<1>() - white.X * linear.noise.b;
  return white;
}

/// A block as all that enters at one place sees it. The whitened columns of an action of one there are P = Q R in each pose, so that a
/// candidate with actions A has the whitened columns Q R A. Of the rows only those along Q meet it: one a picture for what turns a joint,
/// however many corners there are.
struct SeenFrom {
  std::vector<Eigen::MatrixXd> R;  ///< of each pose; none at kPicture, where P is L^-1
  Eigen::MatrixXd X;               ///< Q' L^-1 X
  Eigen::VectorXd residual;        ///< Q' L^-1 (r - X b)
};

/// Whitened columns of an action of one in each observation of a pose, side by side.
Eigen::MatrixXd whiteEntry(const Entry& entry, const CaptureRows& rows, const Whitening& whitening, std::size_t g) {
  const std::vector<std::size_t>& shots = rows.groups[g];
  Eigen::MatrixXd P;
  Eigen::Index row = 0;
  for (std::size_t shot = 0; shot < shots.size(); ++shot) {
    const Eigen::MatrixXd of_shot = entryColumns(entry, rows.observations[shots[shot]]);
    if (shot == 0) P = Eigen::MatrixXd::Zero(whitening.size(g), of_shot.cols() * static_cast<Eigen::Index>(shots.size()));
    P.block(row, static_cast<Eigen::Index>(shot) * of_shot.cols(), of_shot.rows(), of_shot.cols()) = of_shot;
    row += of_shot.rows();
  }
  return whitening.applyTo(g, P);
}

SeenFrom seenFrom(const Entry& entry, const CaptureRows& rows, const Whitening& whitening, const Block& block, const WhiteBlock& white) {
  if (entry.reach == Reach::kPicture) return {{}, white.X, white.residual};
  SeenFrom seen;
  seen.X.resize(block.rows, white.X.cols());
  seen.residual.resize(block.rows);
  Eigen::Index next = 0;
  for (std::size_t g = block.begin; g < block.end; ++g) {
    const Eigen::Index row = whitening.begin(g) - block.row, size = whitening.size(g);
    const Eigen::MatrixXd P = whiteEntry(entry, rows, whitening, g);
    if (P.cols() >= size) {
      seen.R.push_back(P);
      seen.X.middleRows(next, size) = white.X.middleRows(row, size);
      seen.residual.segment(next, size) = white.residual.segment(row, size);
      next += size;
      continue;
    }
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(P);
    const Eigen::Index kept = P.cols();
    Eigen::MatrixXd turned(size, white.X.cols() + 1);
    turned << white.X.middleRows(row, size), white.residual.segment(row, size);
    turned.applyOnTheLeft(qr.householderQ().setLength(kept).adjoint());
    seen.R.emplace_back(qr.matrixQR().topRows(kept).triangularView<Eigen::Upper>());
    seen.X.middleRows(next, kept) = turned.topLeftCorner(kept, white.X.cols());
    seen.residual.segment(next, kept) = turned.topRightCorner(kept, 1);
    next += kept;
  }
  seen.X.conservativeResize(next, Eigen::NoChange);
  seen.residual.conservativeResize(next);
  return seen;
}

/// Candidates that enter at one place, with the sums over the blocks.
struct Chunk {
  Entry entry;
  std::vector<std::size_t> candidates;
  Eigen::Index width = 0;                    ///< columns of all
  std::vector<Eigen::MatrixXd> information;  ///< x' W x of each candidate, the lower half
  Eigen::MatrixXd cross;                     ///< X' W x
  Eigen::VectorXd score;                     ///< x' W (r - X b)
};

std::vector<Chunk> chunksOf(const std::vector<Candidate>& candidates, Eigen::Index base) {
  std::map<Entry, std::vector<Chunk>> by_entry;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Entry entry = candidates[i].entry();
    const Eigen::Index width = candidates[i].typical.size();
    std::vector<Chunk>& chunks = by_entry[entry];
    if (chunks.empty() || chunks.back().width + width > kChunkColumns) chunks.push_back({entry, {}, 0, {}, {}, {}});
    Chunk& chunk = chunks.back();
    chunk.candidates.push_back(i);
    chunk.width += width;
    chunk.information.push_back(Eigen::MatrixXd::Zero(width, width));
  }
  std::vector<Chunk> all;
  for (auto& [entry, chunks] : by_entry) {
    for (Chunk& chunk : chunks) {
      chunk.cross = Eigen::MatrixXd::Zero(base, chunk.width);
      chunk.score = Eigen::VectorXd::Zero(chunk.width);
      all.push_back(std::move(chunk));
    }
  }
  return all;
}

/// R A of each pose, below each other.
void whitenActions(const SeenFrom& seen, const Whitening& whitening, const Block& block, const Eigen::MatrixXd& actions,
                   Eigen::Ref<Eigen::MatrixXd> white) {
  Eigen::Index from = 0, to = 0;
  for (std::size_t g = block.begin; g < block.end; ++g) {
    if (seen.R.empty()) {
      white.middleRows(to, whitening.size(g)) = whitening.applyTo(g, actions.middleRows(from, whitening.size(g)));
      from += whitening.size(g);
      to += whitening.size(g);
      continue;
    }
    const Eigen::MatrixXd& R = seen.R[g - block.begin];
    white.middleRows(to, R.rows()).noalias() = R.lazyProduct(actions.middleRows(from, R.cols()));
    from += R.cols();
    to += R.rows();
  }
}

void addBlock(const std::vector<Candidate>& candidates, const CaptureRows& rows, const Whitening& whitening, const Block& block,
              const SeenFrom& seen, Chunk& chunk) {
  Eigen::MatrixXd white(seen.X.rows(), chunk.width);
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < chunk.candidates.size(); ++i) {
    const Candidate& candidate = candidates[chunk.candidates[i]];
    const Eigen::Index width = candidate.typical.size();
    auto columns = white.middleCols(column, width);
    whitenActions(seen, whitening, block, actionsOf(candidate, rows, block.observation_begin, block.observation_end), columns);
    chunk.information[i].selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
    column += width;
  }
  chunk.cross.noalias() += seen.X.transpose() * white;
  chunk.score.noalias() += white.transpose() * seen.residual;
}

/// The rows of the reference beside those of the target.
void addReference(const Linearised& linear, const std::vector<Candidate>& candidates, Chunk& chunk) {
  const Eigen::Index before = linear.columns.cols();
  Eigen::Index column = 0;
  for (std::size_t k = 0; k < chunk.candidates.size(); ++k) {
    const Candidate& candidate = candidates[chunk.candidates[k]];
    const Eigen::Index width = candidate.typical.size();
    const ReferenceInformation told = referenceInformation(linear, candidate);
    if (told.S.size() > 0) {
      chunk.information[k] += told.S.bottomRightCorner(width, width);
      chunk.cross.block(chunk.cross.rows() - before, column, before, width) += told.S.topRightCorner(before, width);
      chunk.score.segment(column, width) += told.u.tail(width) - told.S.bottomLeftCorner(width, before) * linear.noise.b.tail(before);
    }
    column += width;
  }
}

}  // namespace

std::vector<Evidence> screen(const Linearised& linear, const std::vector<Candidate>& candidates) {
  const Whitening whitening(linear.rows, linear.components, linear.noise.theta);
  std::vector<Chunk> chunks = chunksOf(candidates, linear.rows.J.cols() + linear.columns.cols());
  std::vector<Entry> entries;
  std::vector<std::size_t> entry_of;  // of each chunk
  for (const Chunk& chunk : chunks) {
    if (entries.empty() || entries.back() < chunk.entry) entries.push_back(chunk.entry);
    entry_of.push_back(entries.size() - 1);
  }
  std::vector<SeenFrom> seen(entries.size());
  for (const Block& block : blocksOf(linear.rows)) {
    const WhiteBlock white = whiten(linear, whitening, block);
    parallelFor(entries.size(), linear.jobs, [&](std::size_t i) { seen[i] = seenFrom(entries[i], linear.rows, whitening, block, white); });
    parallelFor(chunks.size(), linear.jobs,
                [&](std::size_t i) { addBlock(candidates, linear.rows, whitening, block, seen[entry_of[i]], chunks[i]); });
  }
  std::vector<Evidence> all(candidates.size());
  parallelFor(chunks.size(), linear.jobs, [&](std::size_t i) {
    Chunk& chunk = chunks[i];
    if (!linear.reference.empty()) addReference(linear, candidates, chunk);
    // The covariance of what is there already is the inverse of its information with the priors.
    const Eigen::MatrixXd explained = linear.noise.covariance * chunk.cross;
    Eigen::Index column = 0;
    for (std::size_t k = 0; k < chunk.candidates.size(); ++k) {
      const Candidate& candidate = candidates[chunk.candidates[k]];
      const Eigen::Index width = candidate.typical.size();
      const Eigen::MatrixXd S = Eigen::MatrixXd(chunk.information[k].selfadjointView<Eigen::Lower>()) -
                                chunk.cross.middleCols(column, width).transpose() * explained.middleCols(column, width);
      all[chunk.candidates[k]] = evidenceOf(S, chunk.score.segment(column, width), candidate);
      column += width;
    }
  });
  return all;
}

}  // namespace poecal
