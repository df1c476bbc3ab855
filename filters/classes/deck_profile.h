// SPDX-License-Identifier: GPL-3.0-or-later
// The shape by which filters/classes/ground_decks.h finds a deck among the ground.
#pragma once

namespace swath::filters::deck_profile {

// Along and across it.
constexpr double deck_grade = 0.15;     // rise / run from cell to cell along a deck
constexpr double deck_roughness = 0.2;  // m, the same
constexpr double across = 0.06;         // rise / run across a deck, from any of its cells; banks fall by more
constexpr double uneven = 0.3;          // m, the same
constexpr double widest = 30.0;         // m
constexpr double narrowest = 2.0;       // m
constexpr double shortest_deck = 3.0;   // m
constexpr double bank_length = 5.0;     // m of ground beyond the ends of a deck

// What is beside it.
constexpr double fall_beside = 1.0;     // m down to what is below
constexpr double sheer = 0.75;          // rise / run from anywhere in a cell to anywhere in the next; banks fall less steeply
constexpr double hidden = 12.0;         // m that are looked at
constexpr double wide_open = 5.0;       // m of them without returns, at least: too few for voids of 3 m cells
constexpr int open_cells = 5;           // cells of them, at least
constexpr int bare = 2;                 // cells without return before what is below
constexpr double banks = 40.0;          // m from the void beside a deck to returns on both sides of it
constexpr double parting = 1.5;         // m per metre by which the sides of water part, at most
constexpr double water_goes_on = 20.0;  // m on, where water still has both sides or ends
constexpr double finest = 1.5;          // m: cells so small may hold the foot of a deck's edge beside it, lower ground, and say nothing
constexpr int edge_cells = 3;           // of the surface before a void
constexpr float edge_fall = 0.2f;       // m down from there: a bank
constexpr double void_at_end = 2.0;     // m of void beside the end of a deck

// What is on it.
constexpr double gap = 3.0;         // m without ground: a vehicle
constexpr double stairs = 2.0;      // m down to the ground at one of its ends
constexpr float near_deck = 0.5f;   // m above or below: kerbs
constexpr float near_rail = 1.3f;   // m above at the edges: railings and parapets
constexpr double rail_reach = 1.0;  // m from the deck's cells, over what is beside them

// How cells make a deck.
constexpr double wedge = 1.2;       // of the least width of the deck
constexpr double oblique = 1.15;    // of the least width of all axes
constexpr double share_open = 0.7;  // of the length of the deck
constexpr int growth = 5;           // cells
constexpr int fewest_beside = 2;    // of the 8 cells around one, of a deck
constexpr int around = 6;           // of them, where ground is enclosed by a deck

}  // namespace swath::filters::deck_profile
