// The factor of an implicit step (dissection, frontal_factor, theta_matrix) against CHOLMOD, on one thread, in one run: from scratch,
// forward and backward substitution, and following a crack. Times are medians of processor time; those of knap hold the making of its
// elements, those of CHOLMOD hold neither these nor the assembly of the matrix (lines of their own). Writes CSV; what is not solved to
// 1e-12 is an error.
#include "cholmod_factor.hpp"

#include <dlfcn.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>
#include <limits>
#include <map>
#include <memory>

using namespace knap;

namespace {

double milliseconds(const std::function<void()>& work) {
    const auto now = [] {
        timespec time;
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
        return 1e3 * time.tv_sec + 1e-6 * time.tv_nsec;
    };
    const double begin = now();
    work();
    return now() - begin;
}

double median(std::vector<double> times) {
    std::ranges::sort(times);
    const std::size_t n = times.size();
    return n % 2 ? times[n / 2] : 0.5 * (times[n / 2 - 1] + times[n / 2]);
}

struct Table {
    struct Line {
        std::vector<double> times;
        double entries = 0, residual = 0;
    };
    std::string blas, body, state;
    Index n_unknowns = 0;
    std::vector<std::pair<std::string, std::string>> order;
    std::map<std::pair<std::string, std::string>, Line> lines;  // by quantity and way

    Line& line(const std::string& quantity, const std::string& way) {
        const auto [at, is_new] = lines.try_emplace({quantity, way});
        if (is_new) order.emplace_back(quantity, way);
        return at->second;
    }
    void write() {
        for (const auto& key : order) {
            const Line& line = lines[key];
            const double time = median(line.times),
                         ours = lines.count({key.first, "knap"}) ? median(lines[{key.first, "knap"}].times) : NAN;
            std::printf("%s,%s,%s,%d,%s,%s,%.4g,", blas.c_str(), body.c_str(), state.c_str(), n_unknowns,
                        key.first.c_str(), key.second.c_str(), time);
            std::printf(std::isnan(ours) ? "-," : "%.3g,", time / ours);
            std::printf(line.entries > 0 ? "%.0f," : "-,", line.entries);
            std::printf(line.residual > 0 ? "%.1e\n" : "-\n", line.residual);
        }
        std::fflush(stdout);
        lines.clear(), order.clear();
    }
};

double residual(const SparseMatrix& A, const Eigen::VectorXd& x, const Eigen::VectorXd& b) {
    const double relative = (A * x - b).norm() / b.norm();
    if (!(relative < 1e-12)) std::fprintf(stderr, "residual %g\n", relative), std::exit(1);
    return relative;
}

SparseMatrix lower(const SparseMatrix& A) { return A.triangularView<Eigen::Lower>(); }

struct Way {
    const char* name;
    int ordering;
    Kind kind;
};
const Way ways[] = {{"CHOLMOD supernodal AMD", CHOLMOD_AMD, Kind::supernodal},
                    {"CHOLMOD supernodal METIS", CHOLMOD_METIS, Kind::supernodal},
                    {"CHOLMOD supernodal NESDIS", CHOLMOD_NESDIS, Kind::supernodal},
                    {"CHOLMOD simplicial AMD", CHOLMOD_AMD, Kind::simplicial},
                    {"CHOLMOD simplicial METIS", CHOLMOD_METIS, Kind::simplicial},
                    {"CHOLMOD simplicial NESDIS", CHOLMOD_NESDIS, Kind::simplicial}};

void from_scratch(const CrackedBody& body, Index n_split, int repeats, Table& table) {
    const Setting setting(body, n_split);
    const SparseMatrix A = assembled(body, setting), L = lower(A);
    const std::vector<Vec2> b = setting.right_hand_side();
    const Eigen::VectorXd flat = setting.as_vector(b);
    table.state = n_split ? std::to_string(n_split) + " nodes split" : "intact";
    table.n_unknowns = setting.n_unknowns;
    std::unique_ptr<ThetaMatrix> ours;
    std::vector<std::unique_ptr<CholmodFactor>> theirs;
    for (const Way& way : ways) theirs.push_back(std::make_unique<CholmodFactor>(way.ordering, way.kind));
    Eigen::VectorXd ours_x;
    for (int round = 0; round <= repeats; ++round) {  // the first one warms up
        const auto time = [&](const char* quantity, const char* way, const std::function<void()>& work) {
            const double ms = milliseconds(work);
            if (round > 0) table.line(quantity, way).times.push_back(ms);
        };
        time("analysis", "knap", [&] { ours = std::make_unique<ThetaMatrix>(body.model, body.mass); });
        ours->set(setting.partition, 2 * body.stiffness_factor);
        if (!ours->factorise(setting.points)) std::exit(1);
        ours->set(setting.partition,
                  body.stiffness_factor);  // now its memory is there, as CHOLMOD's is in the second round
        time("factor", "knap", [&] { ours->factorise(setting.points); });
        std::vector<Vec2> x;
        ours->solve(b, x);
        time("substitution", "knap", [&] { ours->solve(b, x); });
        ours_x = setting.as_vector(x);
        table.line("factor", "knap").entries = static_cast<double>(ours->size().entries);
        table.line("factor", "knap").residual = residual(A, ours_x, flat);
        time("element matrices", "knap", [&] { element_matrices(body); });
        time("element matrices", "and their assembly from triplets", [&] { assembled(body, setting); });
        for (std::size_t i = 0; i < theirs.size(); ++i) {
            const char* name = ways[i].name;
            CholmodFactor& factor = *theirs[i];
            time("analysis", name, [&] { factor.analyse(L); });
            factor.factorise(L);
            time("factor", name,
                 [&] { factor.factorise(L); });  // again: with the symbolic analysis and the memory that are there
            Eigen::VectorXd solved = factor.solve(flat);
            time("substitution", name, [&] { factor.solve(flat); });
            table.line("factor", name).entries = factor.n_entries();
            table.line("factor", name).residual = residual(A, solved, flat);
            if (!((solved - ours_x).norm() < 1e-10 * ours_x.norm()))
                std::fprintf(stderr, "%s: another solution\n", name), std::exit(1);
            const std::vector<int> permutation = factor.permutation();
            time("analysis with a permutation that is known", name, [&] { factor.analyse(L, permutation); });
        }
    }
    table.write();
}

/// Room for every node that the crack will make, beside the node that it splits (CHOLMOD cannot add unknowns): those that are not there
/// yet, or no more, have the rows of the unit matrix. So it is told the path of the crack before; the program is not.
class Extended {
public:
    Extended(const CrackedBody& body, bool splits, int ordering)
        : body_(body),
          intact_(body, 0),
          broken_(body, static_cast<Index>(body.path.size())),
          factor(CHOLMOD_NATURAL, Kind::simplicial) {
        const SparseMatrix A = lower(assembled(body, intact_));
        CholmodFactor ordered(ordering, Kind::simplicial);
        ordered.analyse(A);
        place_of_path_.assign(body.model.fans.size(), -1);
        for (std::size_t i = 0; i < body.path.size() && splits; ++i)
            place_of_path_[body.path[i]] = static_cast<Index>(i);
        std::vector<Index> fan_of_unknown(intact_.n_unknowns);
        for (std::size_t j = 0; j < intact_.unknown.size(); ++j)
            if (intact_.unknown[j] >= 0)
                fan_of_unknown[intact_.unknown[j]] = body.model.fan_of_corner[intact_.partition.corner_of_node[j / 2]];
        std::vector<std::vector<Index>> broken_of_fan(body.model.fans.size());
        for (std::size_t j = 0; j < broken_.unknown.size(); ++j)
            if (broken_.unknown[j] >= 0)
                broken_of_fan[body.model.fan_of_corner[broken_.partition.corner_of_node[j / 2]]].push_back(
                    broken_.unknown[j]);
        intact_at_.assign(intact_.n_unknowns, -1), broken_at_.assign(broken_.n_unknowns, -1);
        for (const int u : ordered.permutation()) {
            intact_at_[u] = n++;
            const Index fan = fan_of_unknown[u];
            if (place_of_path_[fan] < 0) continue;
            for (const Index v : broken_of_fan[fan])
                if (broken_at_[v] < 0) broken_at_[v] = n++;
        }
    }

    std::vector<Index> places(const Setting& setting, Index n_split) const {  // of the setting's unknowns
        std::vector<Index> at(setting.n_unknowns);
        for (std::size_t j = 0; j < setting.unknown.size(); ++j) {
            if (setting.unknown[j] < 0) continue;
            const Index corner = setting.partition.corner_of_node[j / 2],
                        path = place_of_path_[body_.model.fan_of_corner[corner]];
            const bool split = path >= 0 && path < n_split;
            const Setting& from = split ? broken_ : intact_;
            const Index u = from.unknown[2 * from.partition.node_of_corner[corner] + j % 2];
            at[setting.unknown[j]] = split ? broken_at_[u] : intact_at_[u];
        }
        return at;
    }

    SparseMatrix matrix(const Setting& setting, const std::vector<Index>& at, std::vector<char>& there) const {
        const SparseMatrix A = assembled(body_, setting);
        std::vector<Eigen::Triplet<double, int>> entries;
        there.assign(n, 0);
        for (int j = 0; j < A.outerSize(); ++j)
            for (SparseMatrix::InnerIterator entry(A, j); entry; ++entry)
                entries.emplace_back(at[entry.row()], at[j], entry.value());
        for (const Index k : at) there[k] = 1;
        for (int k = 0; k < n; ++k)
            if (!there[k]) entries.emplace_back(k, k, 1);
        SparseMatrix made(n, n);
        made.setFromTriplets(entries.begin(), entries.end());
        return made;
    }

    void begin(const Setting& setting, Index n_split) {
        A = matrix(setting, places(setting, n_split), there);
        factor.analyse(lower(A));
        factor.factorise(lower(A));
    }

    /// Goes on to this setting by rows; milliseconds of what CHOLMOD does.
    double split(const Setting& setting, Index n_split) {
        std::vector<char> to;
        const std::vector<char> from = there;
        const SparseMatrix next = matrix(setting, places(setting, n_split), to);
        double ms = 0;
        for (int k = 0; k < n; ++k)
            if (from[k] && !to[k]) ms += milliseconds([&] { factor.delete_row(k); }), there[k] = 0;
        for (int k = 0; k < n; ++k) {
            if (from[k] || !to[k]) continue;
            there[k] = 1;
            SparseMatrix column(n, 1);
            for (SparseMatrix::InnerIterator entry(next, k); entry; ++entry)
                if (there[entry.row()]) column.insert(entry.row(), 0) = entry.value();
            column.makeCompressed();
            ms += milliseconds([&] { factor.add_row(k, column); });
        }
        // neighbours that came apart together with others change no other row, points that hold are in the rows that are added
        return A = next, ms;
    }

    /// Goes on to a setting of the same nodes and other points: all that change become stronger, or all weaker.
    double update(const Setting& before, const Setting& after, Index n_split) {
        const std::vector<Index> at = places(after, n_split);
        std::map<Index, std::pair<double, const PointTangent*>> change;
        for (const PointTangent& p : before.points) change[p.sides.fan_point] = {-p.block(0, 0), &p};
        for (const PointTangent& p : after.points)
            change[p.sides.fan_point].first += p.block(0, 0), change[p.sides.fan_point].second = &p;
        std::vector<Eigen::Triplet<double, int>> entries;
        int n_columns = 0;
        bool adds = true;
        for (const auto& [fan_point, what] : change) {
            if (what.first == 0) continue;
            adds = what.first > 0;
            for (int k = 0; k < 2; ++k, ++n_columns)
                for (const auto& [node, sign] :
                     {std::pair(what.second->sides.after, 1.0), std::pair(what.second->sides.before, -1.0)})
                    if (const Index u = node < 0 ? -1 : after.unknown[2 * node + k]; u >= 0)
                        entries.emplace_back(at[u], n_columns, sign * std::sqrt(std::abs(what.first)));
        }
        SparseMatrix C(n, n_columns);
        C.setFromTriplets(entries.begin(), entries.end());
        const double ms = milliseconds([&] { factor.update(adds, C); });
        return A = matrix(after, at, there), ms;
    }

    /// The same without modification: all of it anew, with the ordering kept, and also the symbolic analysis where no node has split.
    double anew(Kind kind, bool same_nodes) {
        CholmodFactor& fresh = kind == Kind::simplicial ? simplicial_ : supernodal_;
        const SparseMatrix L = lower(A);
        if (same_nodes) fresh.analyse(L);
        return milliseconds([&] {
            if (!same_nodes) fresh.analyse(L);
            fresh.factorise(L);
        });
    }

    double residual_of_solution() {
        Eigen::VectorXd b(n);
        for (int i = 0; i < n; ++i) b[i] = there[i] ? 1 + i % 11 : 0;
        return residual(A, factor.solve(b), b);
    }

private:
    const CrackedBody& body_;
    const Setting intact_, broken_;
    std::vector<Index> place_of_path_, intact_at_, broken_at_;
    CholmodFactor simplicial_{CHOLMOD_NATURAL, Kind::simplicial}, supernodal_{CHOLMOD_NATURAL, Kind::supernodal};

public:
    int n = 0;
    CholmodFactor factor;
    SparseMatrix A;
    std::vector<char> there;
};

void follow_the_crack(const CrackedBody& body, Table& table) {
    const Index n_path = static_cast<Index>(body.path.size());
    const Setting intact(body, 0), broken(body, n_path);
    const bool splits = broken.n_unknowns > intact.n_unknowns;  // else it comes off the support
    table.state = "crack runs", table.n_unknowns = broken.n_unknowns;
    const std::pair<std::string, int> orderings[] = {{"AMD", CHOLMOD_AMD}, {"METIS", CHOLMOD_METIS}};
    std::vector<std::unique_ptr<Extended>> theirs;
    for (const auto& [name, ordering] : orderings) theirs.push_back(std::make_unique<Extended>(body, splits, ordering));
    ThetaMatrix ours(body.model, body.mass);
    const auto go_to = [&](const Setting& setting) {
        ours.set(setting.partition, body.stiffness_factor);
        if (!ours.factorise(setting.points)) std::exit(1);
    };
    const auto put = [&](const std::string& quantity, std::size_t i, double modified, bool same_nodes) {
        table.line(quantity, "CHOLMOD modified simplicial " + orderings[i].first).times.push_back(modified);
        table.line(quantity, "CHOLMOD anew simplicial " + orderings[i].first)
            .times.push_back(theirs[i]->anew(Kind::simplicial, same_nodes));
        table.line(quantity, "CHOLMOD anew supernodal " + orderings[i].first)
            .times.push_back(theirs[i]->anew(Kind::supernodal, same_nodes));
    };
    const auto check = [&](const std::string& quantity) {
        for (std::size_t i = 0; i < theirs.size(); ++i)
            table.line(quantity, "CHOLMOD modified simplicial " + orderings[i].first).residual =
                theirs[i]->residual_of_solution();
    };
    const auto residual_of_ours = [&](const Setting& setting) {
        std::vector<Vec2> x;
        ours.solve(setting.right_hand_side(), x);
        return residual(assembled(body, setting), setting.as_vector(x), setting.as_vector(setting.right_hand_side()));
    };
    for (const Index k : {Index(1), Index(10), n_path}) {
        const std::string quantity = std::to_string(k) + (splits ? " nodes split" : " nodes come off");
        for (int again = 0; again < (k == n_path ? 3 : 1); ++again) {
            go_to(intact);
            for (auto& extended : theirs) extended->begin(intact, 0);
            std::unique_ptr<Setting> now = std::make_unique<Setting>(body, 0);
            for (Index n_split = k; n_split <= n_path && n_split <= 11 * k; n_split += k) {
                auto next = std::make_unique<Setting>(body, n_split);
                table.line(quantity, "knap").times.push_back(milliseconds([&] { go_to(*next); }));
                for (std::size_t i = 0; i < theirs.size(); ++i)
                    put(quantity, i,
                        splits ? theirs[i]->split(*next, n_split) : theirs[i]->update(*now, *next, n_split), !splits);
                now = std::move(next);
            }
            table.line(quantity, "knap").residual = residual_of_ours(*now);
            check(quantity);
        }
    }
    const Setting& held = splits ? broken : intact;
    const Index n_split = splits ? n_path : 0;
    for (const Index k : {1, 10, 100}) {
        const std::string quantity = std::to_string(k) + " points change";
        const Setting stronger(body, n_split, k);
        go_to(held);
        for (auto& extended : theirs) extended->begin(held, n_split);
        for (int again = 0; again < 6; ++again) {
            const Setting &from = again % 2 ? stronger : held, &to = again % 2 ? held : stronger;
            table.line(quantity, "knap").times.push_back(milliseconds([&] { go_to(to); }));
            for (std::size_t i = 0; i < theirs.size(); ++i)
                put(quantity, i, theirs[i]->update(from, to, n_split), true);
        }
        table.line(quantity, "knap").residual = residual_of_ours(held);
        check(quantity);
    }
    table.write();
}

}  // namespace

int main(int argc, char** argv) {
    omp_set_num_threads(1);
    Table table{.blas = dlsym(RTLD_DEFAULT, "openblas_get_config") ? "OpenBLAS" : "reference"};
    if (argc < 2 || std::strcmp(argv[1], "--no-header") != 0)
        std::puts("blas,matrix,state,unknowns,quantity,by,processor_time_ms,over_knap,entries_of_L,residual");
    for (const auto& [scenario, size] :
         {std::pair("edge_cracked_block_implicit", "2 mm"), std::pair("edge_cracked_block_implicit", "1 mm"),
          std::pair("edge_cracked_block_implicit", "0.5 mm"), std::pair("dcb_displacement", "")}) {
        const CrackedBody body = cracked_body(scenario, size, 100);
        table.body = body.name;
        from_scratch(body, 0, 5, table);
        from_scratch(body, static_cast<Index>(body.path.size()), 5, table);
        follow_the_crack(body, table);
    }
}
