(* SPDX-License-Identifier: BSD-3-Clause *)
(** * The walk over a proof, and the theorem

    As verify/proof.cpp: a node is about a task, that is pieces of a body A, a list of partners and an interval of time;
    TIME, PARTNERS, OWN and OTHER cut their task in two parts that cover it. *)
From Coq Require Import Reals ZArith Lia Lra String Bool List.
From FclArtic Require Import Statement Numbers Trig Frames Enclose Meaning Reasons Reach Tube Leaf Witness.
Import ListNotations.
Open Scope R_scope.

(** ** Proofs *)

(** In which frame a direction is constant: the world, that of A, that of the first partner. *)
Inductive place := InWorld | InOwn | InPartners.

Inductive node :=
  | Sep (where_ : place) (x y z : Z)
  | AtWall (turned : bool)                                (* WALL *)
  | Time (first second : node)
  | Partners (count : nat) (first second : node)
  | Own (count : nat) (first second : node)
  | Other (count : nat) (first second : node).

(** How often a leaf halves time. *)
Definition leaf_halvings : nat := 14.

Definition frame_of (where_ : place) (A : sbody) (ps : list partner) : nat :=
  match where_, ps with
  | InWorld, _ => O
  | InOwn, _ => sb_frame A
  | InPartners, p :: _ => sb_frame (p_body p)
  | InPartners, [] => O
  end.

(** Whether both parts of a list are there: the format asks for it, the proof below does not. *)
Definition cuts (count size : nat) : bool := Nat.ltb 0 count && Nat.ltb count size.

Section Check.
Variable sfs : list sframe.
Variable q : spiece.
Variable pl : plays.
Variable A : sbody.

(** Partners that are ignored up to a time take part from then on. *)
Definition leaf (n : line) (os : forest) (ps : list partner) (a b : Z) (ts : poses) : bool :=
  Nat.leb (l_frame n) (length sfs) &&
  separated leaf_halvings sfs q pl A os n (filter (fun p => Z.leb (p_from p) a) ps) a b ts &&
  forallb (fun p => Z.leb (p_from p) a || Z.leb b (p_from p) ||
                    separated leaf_halvings sfs q pl A os n [p] (p_from p) b (poses_from 0 sfs q (p_from p) b)) ps.

Fixpoint check (nd : node) (os : forest) (ps : list partner) (a b : Z) (ts : poses) : bool :=
  match nd with
  | Sep where_ x y z => leaf (along (frame_of where_ A ps) x y z) os ps a b ts
  | AtWall turned =>
      match ps with
      | [p] => match wall_line A os p turned with Some n => leaf n os ps a b ts | None => false end
      | _ => false
      end
  | Time l r =>
      let (first, second) := halves sfs q ts a b in check l os ps a (middle a b) first && check r os ps (middle a b) b second
  | Partners k l r => cuts k (length ps) && (check l os (firstn k ps) a b ts && check r os (skipn k ps) a b ts)
  | Own k l r => match split k os with Some (x, y) => check l x ps a b ts && check r y ps a b ts | None => false end
  | Other k l r =>
      match ps with
      | [p] =>
          match split k (p_pieces p) with
          | Some (x, y) =>
              check l os [Partner (p_body p) x (p_margin p) (p_from p)] a b ts &&
              check r os [Partner (p_body p) y (p_margin p) (p_from p)] a b ts
          | None => false
          end
      | _ => false
      end
  end.
End Check.

(** ** Bodies, pairs, pieces of the motion *)

Record prepared := Prepared { pr_number : nat; pr_body : body; pr_sbody : sbody; pr_pieces : forest }.
Definition prepare (w : world) (i : nat) (b : body) : prepared :=
  Prepared i b (Sbody (body_frame b) (placed (body_place b)) (body_give w b)) (forest_of (outlines (body_geometry b))).
Fixpoint prepare_all (w : world) (i : nat) (bs : list body) : list prepared :=
  match bs with [] => [] | b :: rest => prepare w i b :: prepare_all w (S i) rest end.

(** Until when a pair is ignored; before all times, if it is not. *)
Definition ignored_until (p : piece) (i j : nat) : Z :=
  fold_right (fun e latest => let '(k, l, u) := e in
                if Nat.eqb k i && Nat.eqb l j then Z.max (number_down u) latest else latest) (- one)%Z (ignored p).

Definition margin_up := rounded_margin number_up.

Definition partner_of (w : world) (m : motion) (p : piece) (b a : prepared) : partner :=
  Partner (pr_sbody a) (pr_pieces a) (margin_up w m (pr_body a) (pr_body b))
    (ignored_until p (pr_number a) (pr_number b)).

(** One root for each body that has partners before it; the nodes that are left over. *)
Fixpoint check_bodies (w : world) (m : motion) (sfs : list sframe) (p : piece) (pl : plays) (until_up : Z)
    (ts : poses) (before rest : list prepared) (nodes : list node) : option (list node) :=
  match rest with
  | [] => Some nodes
  | b :: rest' =>
      match filter (fun a => checked w m (pr_body a) (pr_body b)) before with
      | [] => check_bodies w m sfs p pl until_up ts (before ++ [b]) rest' nodes
      | partners =>
          match nodes with
          | [] => None
          | nd :: nodes' =>
              if check sfs (spiece_of p) pl (pr_sbody b) nd (pr_pieces b) (map (partner_of w m p b) partners) 0 until_up ts
              then check_bodies w m sfs p pl until_up ts (before ++ [b]) rest' nodes'
              else None
          end
      end
  end.

Fixpoint check_pieces (w : world) (m : motion) (sfs : list sframe) (bs : list prepared) (ps : list piece)
    (nodes : list node) : option (list node) :=
  match ps with
  | [] => Some nodes
  | p :: rest =>
      let until_up := match rest with [] => number_up (until m) | _ => one end in
      let ts := poses_from (kept_depth sfs) sfs (spiece_of p) 0 until_up in
      match check_bodies w m sfs p (plays_of w (spiece_of p)) until_up ts [] bs nodes with
      | Some nodes' => check_pieces w m sfs bs rest nodes'
      | None => None
      end
  end.

(** Whether pieces join; 2^35, 2^44, 2^37: 2^-29, 2^-20 and 2^-27 in units. *)
Definition value_joins (p p' : piece) (v : nat) (m : number) : bool :=
  let x := tm_mul (tm_number m) (value_tm p one v) in
  let y := tm_mul (tm_number m) (value_tm p' 0 v) in
  Z.leb (bound (tm_sub x y)) (2 ^ 35 + Z.min (Z.shiftr (Z.abs (c0 x) - rem x) 39) (2 ^ 44)).

(** The rows of a frame's rotation, each as what a coordinate of the parent is in the frame. *)
Definition rows (f : frame) (p : piece) (t : Z) : list tvec :=
  let sts := placed (origin f) :: flat_map (steps_of (state_at (spiece_of p) (const t 0))) (map selement_of (elements f)) in
  map (fun n => fv (down_all sts (Func n tm_zero))) units.
Definition row_joins (r r' : tvec) : bool :=
  let near x y := Z.leb (bound (tm_sub x y)) (2 ^ 37) in near (tx r) (tx r') && near (ty r) (ty r') && near (tz r) (tz r').
Definition frame_joins (p p' : piece) (f : frame) : bool :=
  forallb (fun e => match e with Turn _ v m _ | Slide _ v m _ => value_joins p p' v m | Rotate _ => true end) (elements f) &&
  (negb (existsb (fun e => match e with Rotate _ => true | _ => false end) (elements f)) ||
   forallb (fun rr => row_joins (fst rr) (snd rr)) (combine (rows f p one) (rows f p' 0))).
Fixpoint pieces_join (w : world) (ps : list piece) : bool :=
  match ps with
  | p :: (p' :: _) as rest => forallb (frame_joins p p') (frames w) && pieces_join w rest
  | _ => true
  end.

Fixpoint parents_ok (i : nat) (fs : list frame) : bool :=
  match fs with [] => true | f :: rest => Nat.leb (parent f) i && parents_ok (S i) rest end.
Definition is_well_formed (w : world) : bool :=
  parents_ok 0 (frames w) && forallb (fun b => Nat.leb (body_frame b) (length (frames w))) (bodies w).

Definition is_meaningful (w : world) (m : motion) : bool :=
  tolerances_mean (off w) && forallb frame_means (frames w) && forallb piece_means (pieces m) && forallb (fun b => has_rotation (body_place b)) (bodies w).

(** The program prepares a world once, for all records about it. *)
Definition prepare_world (w : world) : list prepared := prepare_all w 0 (bodies w).
Definition accepts_prepared (bs : list prepared) (w : world) (m : motion) (nodes : list node) : bool :=
  is_well_formed w && is_meaningful w m && reasons_ok w && pieces_join w (pieces m) &&
  match check_pieces w m (map sframe_of (frames w)) bs (pieces m) nodes with
  | Some [] => true
  | _ => false
  end.
Definition accepts (w : world) (m : motion) (nodes : list node) : bool := accepts_prepared (prepare_world w) w m nodes.

(** ** Soundness *)

Section Sound.
Variable w : world.
Hypothesis WF : well_formed w.
Variable m : motion.
Let sfs := map sframe_of (frames w).

Lemma leaf_ok pc A n os ps a b ts : leaf sfs (spiece_of pc) (plays_of w (spiece_of pc)) A n os ps a b ts = true ->
  (exists d, ts = poses_from d sfs (spiece_of pc) a b) -> forall t P P' p, line_ok n A os p -> V a <= t <= V b ->
  frames_at w (at_time pc t) P P' -> In p ps -> V (p_from p) < t -> keeps P' A os p.
Proof.
  unfold leaf. rewrite !andb_true_iff. intros [[L S1] S2] [d ->] t P P' p LO Ht HP Ip Hp. apply Nat.leb_le in L.
  unfold sfs in L. rewrite map_length in L. rewrite forallb_forall in S2. specialize (S2 p Ip).
  rewrite !orb_true_iff in S2. destruct S2 as [[E|E]|E]; [| apply Z.leb_le, V_le in E; lra |].
  - eapply separated_ok; [exact WF | exact L | exact S1 | exact LO | exact Ht | exact HP|]. apply filter_In. split; assumption.
  - eapply separated_ok; [exact WF | exact L | exact E | exact LO | | exact HP | left; reflexivity]. lra.
Qed.

Lemma check_ok pc A nd : forall os ps a b ts, check sfs (spiece_of pc) (plays_of w (spiece_of pc)) A nd os ps a b ts = true ->
  (exists d, ts = poses_from d sfs (spiece_of pc) a b) ->
  forall t P P' p, V a <= t <= V b -> frames_at w (at_time pc t) P P' -> In p ps -> V (p_from p) < t -> keeps P' A os p.
Proof.
  induction nd as [wh x y z | turned | l IHl r IHr | k l IHl r IHr | k l IHl r IHr | k l IHl r IHr];
    intros os ps a b ts H TS t P P' p Ht HP Ip Hp; cbn [check] in H.
  - eapply leaf_ok; [exact H | exact TS | apply along_ok | exact Ht | exact HP | exact Ip | exact Hp].
  - destruct ps as [|p' [|]]; try discriminate. destruct Ip as [->|[]].
    destruct (wall_line A os p turned) as [n|] eqn:W; [|discriminate].
    eapply leaf_ok; [exact H | exact TS | eapply wall_line_ok; exact W | exact Ht | exact HP | left; reflexivity | exact Hp].
  - destruct TS as [d ->]. destruct (halves_are d sfs (spiece_of pc) a b) as [e E]. rewrite E in H.
    apply andb_true_iff in H. destruct H as [H1 H2].
    destruct (Rle_lt_dec t (V (middle a b))) as [L|G];
      [eapply IHl; [exact H1 | exists e; reflexivity | | exact HP | exact Ip | exact Hp]
      | eapply IHr; [exact H2 | exists e; reflexivity | | exact HP | exact Ip | exact Hp]]; lra.
  - rewrite !andb_true_iff in H. destruct H as [_ [H1 H2]]. rewrite <- (firstn_skipn k ps) in Ip. apply in_app_or in Ip.
    destruct Ip as [I|I]; [eapply IHl | eapply IHr]; eassumption.
  - destruct (split k os) as [[x y]|] eqn:E; [|discriminate]. apply andb_true_iff in H. destruct H as [H1 H2].
    intros F F' G G' HF HG x' y' o o' Io Co Io' Co'.
    destruct (split_has _ _ _ _ _ E Io) as [I|I]; [eapply IHl | eapply IHr]; eassumption.
  - destruct ps as [|p' [|]]; try discriminate. destruct Ip as [->|[]].
    destruct (split k (p_pieces p)) as [[x y]|] eqn:E; [|discriminate]. apply andb_true_iff in H. destruct H as [H1 H2].
    intros F F' G G' HF HG x' y' o o' Io Co Io' Co'. destruct (split_has _ _ _ _ _ E Io') as [I|I].
    + exact (IHl _ _ _ _ _ H1 TS t P P' _ Ht HP (or_introl eq_refl) Hp F F' G G' HF HG x' y' o o' Io Co I Co').
    + exact (IHr _ _ _ _ _ H2 TS t P P' _ Ht HP (or_introl eq_refl) Hp F F' G G' HF HG x' y' o o' Io Co I Co').
Qed.

Lemma margin_up_ok a b : margin w m a b <= V (margin_up w m a b).
Proof.
  unfold margin, margin_up, rounded_margin. rewrite V_add. apply Rplus_le_compat; [apply number_up_ok|].
  destruct (pair_margin w a b); [apply number_up_ok|].
  destruct (own_margin w a) as [x|], (own_margin w b) as [y|]; try apply number_up_ok.
  destruct (V_max (number_up x) (number_up y)) as [L1 L2].
  pose proof (number_up_ok x). pose proof (number_up_ok y). apply Rmax_lub; lra.
Qed.

Lemma ignored_until_ok p i j t : 0 <= t -> (forall u, In (i, j, u) (ignored p) -> real u < t) ->
  V (ignored_until p i j) < t.
Proof.
  intros H0 H. unfold ignored_until. induction (ignored p) as [|[[k l] u] rest IH]; cbn [fold_right].
  - rewrite V_opp, V_one. lra.
  - specialize (IH (fun v I => H v (or_intror I))).
    destruct (Nat.eqb_spec k i) as [->|_]; [|exact IH]. destruct (Nat.eqb_spec l j) as [->|_]; [|exact IH].
    cbn [andb]. pose proof (H u (or_introl eq_refl)). pose proof (number_down_ok u).
    destruct (Z.max_spec (number_down u) (fold_right (fun e latest => let '(k, l, u0) := e in
      if Nat.eqb k i && Nat.eqb l j then Z.max (number_down u0) latest else latest) (- one)%Z rest)) as [[_ ->]|[_ ->]];
      [exact IH | lra].
Qed.

(** What one root shows. *)
Lemma root_ok pc u ts nd i j (a b : body) (before : list prepared) t : In (prepare w i a) before -> checked w m a b = true ->
  check sfs (spiece_of pc) (plays_of w (spiece_of pc)) (pr_sbody (prepare w j b)) nd (pr_pieces (prepare w j b))
    (map (partner_of w m pc (prepare w j b)) (filter (fun p => checked w m (pr_body p) b) before)) 0 u ts = true ->
  (exists d, ts = poses_from d sfs (spiece_of pc) 0 u) ->
  0 <= t <= V u -> (forall v, In (i, j, v) (ignored pc) -> real v < t) -> apart w m (at_time pc t) a b.
Proof.
  intros Ia C H TS Ht HI P P' A B F G HP HA HB HF HG x y (x' & Ix & ->) (y' & Iy & ->).
  assert (Ip : In (partner_of w m pc (prepare w j b) (prepare w i a))
    (map (partner_of w m pc (prepare w j b)) (filter (fun p => checked w m (pr_body p) b) before))).
  { apply in_map. apply filter_In. split; [exact Ia | exact C]. }
  pose proof (ignored_until_ok pc i j t (proj1 Ht) HI) as Hu.
  rewrite <- V_0 in Ht. pose proof (check_ok pc _ nd _ _ _ _ _ H TS t P P' _ Ht HP Ip Hu) as K.
  destruct (outlines_cover _ _ Ix) as (o & Io & Co). destruct (outlines_cover _ _ Iy) as (o' & Io' & Co').
  apply forest_of_has in Io, Io'.
  assert (N : norm (sub (P' (body_frame a) (A (F x'))) (P' (body_frame b) (B (G y')))) =
              norm (sub (P' (body_frame b) (B (G y'))) (P' (body_frame a) (A (F x'))))).
  { unfold norm. f_equal. unfold dot, sub, add, scale; cbn [vx vy vz]. ring. }
  rewrite N. apply Rle_lt_trans with (V (margin_up w m a b)); [apply margin_up_ok|].
  assert (ST : forall c C D s, pose_map (body_place c) C -> pose_off (body_tolerance w c) D ->
    stands s (Sbody (body_frame c) (placed (body_place c)) (body_give w c)) C (fun p => C (D p))).
  { intros c C' D s HC HD. pose proof (placed_ok s _ _ HC) as HS. pose proof (pose_off_isometry _ _ HD) as ID.
    assert (IC : isometry C') by (intros p p'; apply (step_keeps s _ _ p p' HS)).
    split; [exact HS|]. split; [intros p p'; rewrite (IC _ _); apply ID|]. split; [|apply pose_off_moves; assumption].
    intros p. destruct (step_onto s _ _ HS p) as [p1 <-]. destruct (pose_off_onto _ _ HD p1) as [p2 <-]. exists p2. reflexivity. }
  exact (K B (fun p => B (G p)) A (fun p => A (F p)) (fun s => ST b B G s HB HG) (fun s => ST a A F s HA HF)
    y' x' o' o Io' Co' Io Co).
Qed.

(** All pairs of [rest], whose numbers begin with n, with what stands before them. *)
Lemma check_bodies_ok pc u ts rest : (exists d, ts = poses_from d sfs (spiece_of pc) 0 u) ->
  forall n before nodes left, check_bodies w m sfs pc (plays_of w (spiece_of pc)) u ts before (prepare_all w n rest) nodes = Some left ->
  forall k b i a t, nth_error rest k = Some b ->
  In (prepare w i a) before \/ (exists k', (k' < k)%nat /\ nth_error rest k' = Some a /\ i = (n + k')%nat) ->
  checked w m a b = true -> 0 <= t <= V u -> (forall v, In (i, (n + k)%nat, v) (ignored pc) -> real v < t) ->
  apart w m (at_time pc t) a b.
Proof.
  intros TS. induction rest as [|c rest IH]; intros n before nodes left H k b i a t Nb Ia C Ht HI.
  - destruct k; discriminate.
  - cbn [prepare_all check_bodies] in H.
    set (found := filter (fun p => checked w m (pr_body p) (pr_body (prepare w n c))) before) in *.
    destruct k as [|k].
    + cbn in Nb. injection Nb as ->. destruct Ia as [Ia|(k' & L & _)]; [|lia]. rewrite Nat.add_0_r in HI.
      destruct found as [|p ps] eqn:F.
      * assert (I : In (prepare w i a) found) by (apply filter_In; split; [exact Ia | exact C]). rewrite F in I. destruct I.
      * destruct nodes as [|nd nodes']; [discriminate|].
        destruct (check sfs _ _ _ nd _ _ 0 u ts) eqn:K; [|discriminate].
        apply (root_ok pc u ts nd i n a b before t Ia C); [|exact TS | exact Ht | exact HI].
        change (filter (fun p => checked w m (pr_body p) b) before) with found. rewrite F. exact K.
    + cbn [nth_error] in Nb.
      assert (LATER : forall nodes', check_bodies w m sfs pc (plays_of w (spiece_of pc)) u ts (before ++ [prepare w n c])
        (prepare_all w (S n) rest) nodes' = Some left -> apart w m (at_time pc t) a b).
      { intros nodes' H'. replace (n + S k)%nat with (S n + k)%nat in HI by lia.
        apply (IH _ _ _ _ H' k b i a t Nb); [|exact C | exact Ht | exact HI].
        destruct Ia as [Ia|(k' & L & Na & ->)]; [left; apply in_or_app; left; exact Ia|].
        destruct k' as [|k'].
        - cbn in Na. injection Na as ->. left. apply in_or_app. right. left. rewrite Nat.add_0_r. reflexivity.
        - right. exists k'. split; [lia|]. split; [exact Na | lia]. }
      destruct found as [|p ps]; [exact (LATER _ H)|].
      destruct nodes as [|nd nodes']; [discriminate|].
      destruct (check sfs _ _ _ nd _ _ 0 u ts); [|discriminate]. exact (LATER _ H).
Qed.

Lemma check_pieces_ok ps : forall nodes left,
  check_pieces w m sfs (prepare_all w 0 (bodies w)) ps nodes = Some left ->
  forall k p, nth_error ps k = Some p ->
  let u := if Nat.eqb (S k) (length ps) then number_up (until m) else one in
  exists nodes' left', check_bodies w m sfs p (plays_of w (spiece_of p)) u (poses_from (kept_depth sfs) sfs (spiece_of p) 0 u) []
    (prepare_all w 0 (bodies w)) nodes' = Some left'.
Proof.
  induction ps as [|p0 rest IH]; intros nodes left H k p N; [destruct k; discriminate|]. cbn [check_pieces] in H.
  destruct (check_bodies w m sfs p0 _ _ _ [] _ nodes) as [nodes1|] eqn:B; [|discriminate].
  destruct k as [|k].
  - cbn in N. injection N as <-. exists nodes, nodes1. rewrite <- B. destruct rest; reflexivity.
  - cbn [nth_error] in N. destruct (IH _ _ H k p N) as (n' & l' & E). exists n', l'. exact E.
Qed.

Lemma value_joins_ok p p' v mm : value_joins p p' v mm = true ->
  let x := real mm * value p 1 v in
  Rabs (x - real mm * value p' 0 v) <= / 2 ^ 29 + Rmin (Rabs x / 2 ^ 39) (/ 2 ^ 20).
Proof.
  unfold value_joins.
  intros H. apply Z.leb_le, V_le in H. set (xm := tm_mul (tm_number mm) (value_tm p one v)) in *.
  assert (Z1 : Rabs 0 <= 1) by (rewrite Rabs_R0; lra).
  pose proof (value_ok p one v) as H1. rewrite V_one in H1. pose proof (value_ok p' 0 v) as H0. rewrite V_0 in H0.
  pose proof (holds_mul _ _ 0 _ _ Z1 (holds_number 0 mm) H1) as HX. fold xm in HX.
  pose proof (holds_mul _ _ 0 _ _ Z1 (holds_number 0 mm) H0) as HY.
  pose proof (bound_ge _ 0 _ Z1 (holds_sub _ _ _ _ _ HX HY)) as B.
  set (x := real mm * value p 1 v) in *.
  assert (X : V (Z.abs (c0 xm) - rem xm) <= Rabs x).
  { rewrite V_sub, V_abs. unfold holds, poly in HX.
    replace (V (c0 xm) + V (c1 xm) * 0 + V (c2 xm) * (0 * 0)) with (V (c0 xm)) in HX by ring.
    pose proof (Rabs_triang x (V (c0 xm) - x)) as T. replace (x + (V (c0 xm) - x)) with (V (c0 xm)) in T by ring.
    rewrite <- Rabs_Ropp in HX. replace (- (x - V (c0 xm))) with (V (c0 xm) - x) in HX by ring. lra. }
  set (k := (Z.abs (c0 xm) - rem xm)%Z) in *.
  pose proof (shiftr_err k 39 ltac:(lia)) as S. rewrite two_power in S by lia.
  replace (powerRZ 2 39) with (2 ^ 39) in S by (change 39%Z with (Z.of_nat 39); rewrite pow_powerRZ; reflexivity).
  rewrite V_add in H. 
  assert (E29 : V (2 ^ 35) = / 2 ^ 29) by (symmetry; exact (power_neg 29 ltac:(lia))). rewrite E29 in H.
  assert (M : V (Z.min (Z.shiftr k 39) (2 ^ 44)) <= Rmin (Rabs x / 2 ^ 39) (/ 2 ^ 20)).
  { apply Rmin_glb.
    - apply Rle_trans with (V (Z.shiftr k 39)); [apply V_le; lia|].
      apply Rle_trans with (V k / 2 ^ 39); [lra|]. apply Rmult_le_compat_r; [|exact X].
      left. apply Rinv_0_lt_compat, pow_lt. lra.
    - apply Rle_trans with (V (2 ^ 44)); [apply V_le; lia|]. apply Req_le. symmetry. apply (power_neg 20). lia. }
  cbv zeta. lra.
Qed.

(** What a row says at one time: the coordinate n of the ways of the axes. *)
Lemma row_ok sts E n nm : holds_steps 0 sts E -> holdsv nm 0 n ->
  let r := fv (down_all sts (Func nm tm_zero)) in
  holds (tx r) 0 (dot n (way E (Vec 1 0 0))) /\ holds (ty r) 0 (dot n (way E (Vec 0 1 0))) /\
  holds (tz r) 0 (dot n (way E (Vec 0 0 1))).
Proof.
  intros HE Hn. assert (Z1 : Rabs 0 <= 1) by (rewrite Rabs_R0; lra).
  destruct (down_all_ok 0 Z1 sts E (Func nm tm_zero) n 0 HE) as (v & d & [(A & B & C) _] & _ & X).
  { split; [exact Hn | apply holds_zero]. }
  assert (W : forall a, dot n (way E a) = dot v a).
  { intros a. unfold way. replace (dot n (sub (E a) (E (Vec 0 0 0)))) with ((dot n (E a) + 0) - (dot n (E (Vec 0 0 0)) + 0))
      by (unfold dot, sub, add, scale; cbn [vx vy vz]; ring). rewrite !X. unfold dot; cbn [vx vy vz]. ring. }
  cbv zeta. rewrite !W. repeat split; (eapply holds_eq; [|eassumption]; unfold dot; cbn [vx vy vz]; ring).
Qed.

Lemma row_joins_ok r r' x y z x' y' z' : row_joins r r' = true ->
  (holds (tx r) 0 x /\ holds (ty r) 0 y /\ holds (tz r) 0 z) ->
  (holds (tx r') 0 x' /\ holds (ty r') 0 y' /\ holds (tz r') 0 z') ->
  Rabs (x - x') <= / 2 ^ 27 /\ Rabs (y - y') <= / 2 ^ 27 /\ Rabs (z - z') <= / 2 ^ 27.
Proof.
  unfold row_joins. rewrite !andb_true_iff, !Z.leb_le. intros [[L1 L2] L3] (A & B & C) (A' & B' & C').
  assert (Z1 : Rabs 0 <= 1) by (rewrite Rabs_R0; lra).
  assert (E : V (2 ^ 37) = / 2 ^ 27) by (symmetry; exact (power_neg 27 ltac:(lia))).
  apply V_le in L1, L2, L3. rewrite E in L1, L2, L3.
  pose proof (bound_ge _ 0 _ Z1 (holds_sub _ _ _ _ _ A A')). pose proof (bound_ge _ 0 _ Z1 (holds_sub _ _ _ _ _ B B')).
  pose proof (bound_ge _ 0 _ Z1 (holds_sub _ _ _ _ _ C C')). repeat split; lra.
Qed.

Lemma frame_joins_ok p p' f : frame_joins p p' f = true -> forall e, In e (elements f) -> element_joined w p p' f e.
Proof.
  unfold frame_joins, element_joined. rewrite andb_true_iff, forallb_forall. intros [H1 H2] e Ie. specialize (H1 e Ie).
  destruct e as [a v mm c | a v mm c | v]; [apply value_joins_ok; exact H1 | apply value_joins_ok; exact H1|].
  intros O M M' N N' HO HM HM'. apply orb_true_iff in H2. destruct H2 as [H2|H2].
  { apply negb_true_iff in H2. assert (K : existsb (fun e => match e with Rotate _ => true | _ => false end) (elements f) = true)
      by (apply existsb_exists; exists (Rotate v); split; [exact Ie | reflexivity]). congruence. }
  assert (Z1 : Rabs 0 <= 1) by (rewrite Rabs_R0; lra).
  assert (ST : forall pc t M N, elements_map w (at_time pc (V t)) (elements f) M N ->
    holds_steps 0 (placed (origin f) :: flat_map (steps_of (state_at (spiece_of pc) (const t 0))) (map selement_of (elements f)))
      (fun x => O (M x))).
  { intros pc t M0 N0 HN. apply first_step with (E := O) (M := M0); [apply placed_ok; exact HO | | reflexivity].
    apply all_steps_ok with w (at_time pc (V t)) N0; [exact Z1 | apply state_ok; [exact Z1 | apply holds_exact] | exact HN]. }
  rewrite <- V_one in HM. rewrite <- V_0 in HM'. pose proof (ST p one M N HM) as S1. pose proof (ST p' 0%Z M' N' HM') as S2.
  assert (U : Forall2 (fun m n => holdsv m 0 n) units [Vec 1 0 0; Vec 0 1 0; Vec 0 0 1]).
  { repeat (apply Forall2_cons; [repeat split; cbn [tx ty tz vx vy vz]; try apply holds_zero; apply holds_one|]). constructor. }
  unfold rows in H2.
  set (sts1 := placed (origin f) :: flat_map (steps_of (state_at (spiece_of p) (const one 0))) (map selement_of (elements f))) in *.
  set (sts2 := placed (origin f) :: flat_map (steps_of (state_at (spiece_of p') (const 0 0))) (map selement_of (elements f))) in *.
  unfold units in *. cbn [map combine forallb fst snd] in H2. rewrite !andb_true_iff in H2. destruct H2 as (J1 & J2 & J3 & _).
  inversion U as [|? ? ? ? U1 U' ]; subst. inversion U' as [|? ? ? ? U2 U'' ]; subst. inversion U'' as [|? ? ? ? U3 _ ]; subst.
  pose proof (row_joins_ok _ _ _ _ _ _ _ _ J1 (row_ok _ _ _ _ S1 U1) (row_ok _ _ _ _ S2 U1)) as (A1 & A2 & A3).
  pose proof (row_joins_ok _ _ _ _ _ _ _ _ J2 (row_ok _ _ _ _ S1 U2) (row_ok _ _ _ _ S2 U2)) as (B1 & B2 & B3).
  pose proof (row_joins_ok _ _ _ _ _ _ _ _ J3 (row_ok _ _ _ _ S1 U3) (row_ok _ _ _ _ S2 U3)) as (C1 & C2 & C3).
  assert (D : forall a, dot (Vec 1 0 0) a = vx a /\ dot (Vec 0 1 0) a = vy a /\ dot (Vec 0 0 1) a = vz a).
  { intros a. unfold dot; cbn [vx vy vz]. repeat split; ring. }
  rewrite ?(proj1 (D _)), ?(proj1 (proj2 (D _))), ?(proj2 (proj2 (D _))) in *.
  intros axis [<-|[<-|[<-|[]]]]; repeat split; assumption.
Qed.

Lemma pieces_join_ok ps : pieces_join w ps = true ->
  forall k p p', nth_error ps k = Some p -> nth_error ps (S k) = Some p' -> joined w p p'.
Proof.
  induction ps as [|p0 rest IH]; intros H k p p' Np Np'; [destruct k; discriminate|].
  destruct rest as [|p1 rest]; [destruct k as [|[|]]; discriminate|].
  cbn [pieces_join] in H. apply andb_true_iff in H. destruct H as [H1 H2]. destruct k as [|k].
  - cbn in Np, Np'. injection Np as <-. injection Np' as <-. intros f e If Ie.
    rewrite forallb_forall in H1. exact (frame_joins_ok p0 p1 f (H1 f If) e Ie).
  - exact (IH H2 k p p' Np Np').
Qed.
End Sound.

Lemma parents_ok_spec fs : forall i, parents_ok i fs = true ->
  forall k f, nth_error fs k = Some f -> (parent f <= i + k)%nat.
Proof.
  induction fs as [|f0 fs IH]; intros i H k f N; [destruct k; discriminate|]. cbn [parents_ok] in H.
  apply andb_true_iff in H. destruct H as [H1 H2]. apply Nat.leb_le in H1. destruct k as [|k].
  - injection N as <-. lia.
  - specialize (IH _ H2 k f N). lia.
Qed.

Lemma is_well_formed_ok w : is_well_formed w = true -> well_formed w.
Proof.
  intros H. apply andb_true_iff in H. destruct H as [H1 H2]. split.
  - intros i f N. exact (parents_ok_spec _ 0 H1 i f N).
  - intros b I. rewrite forallb_forall in H2. apply Nat.leb_le, H2, I.
Qed.

Lemma is_meaningful_ok w m : well_formed w -> is_meaningful w m = true -> meaningful w m.
Proof.
  intros WF HM. unfold is_meaningful in HM. rewrite !andb_true_iff in HM. destruct HM as [[[M0 M1] M3] M2]. split.
  - intros p t I. rewrite forallb_forall in M3. apply frames_exist; [exact M0 | apply piece_means_ok, M3, I | apply WF | exact M1].
  - intros b I. rewrite forallb_forall in M2. destruct (has_rotation_ok _ (M2 b I)) as [B HB]. exists B. split; [exact HB|].
    apply not_off. intros t. apply tolerance_found. unfold tolerances_mean in M0. rewrite !andb_true_iff in M0. apply M0.
Qed.

(** That two bodies meet in the end. *)
Definition accepts_meeting (w : world) (m : motion) (k i j : nat) (t : number) (first : bool) (wt : witness) : bool :=
  is_well_formed w && is_meaningful w m && meets_ok w m k i j t first wt.

Theorem accepts_meeting_sound w m k i j t first wt : accepts_meeting w m k i j t first wt = true ->
  meaningful w m /\ meets w m (only_near wt) k i j t.
Proof.
  unfold accepts_meeting. rewrite !andb_true_iff. intros [[HW HM] H]. pose proof (is_well_formed_ok w HW) as WF.
  split; [exact (is_meaningful_ok w m WF HM) | exact (meets_ok_sound w m k i j t first wt WF H)].
Qed.

Theorem accepts_sound w m nodes : accepts w m nodes = true -> claim w m.
Proof.
  unfold accepts, accepts_prepared, prepare_world. rewrite !andb_true_iff. intros [[[[HW HM] HR] HJ] H].
  pose proof (is_well_formed_ok w HW) as WF.
  split.
  { exact (is_meaningful_ok w m WF HM). }
  split; [apply reasons_ok_ok; exact HR|]. split.
  { apply pieces_join_ok. exact HJ. }
  intros k p Np i j a b Hij Na Nb C t Ht HI.
  destruct (check_pieces w m (map sframe_of (frames w)) (prepare_all w 0 (bodies w)) (pieces m) nodes) as [left|] eqn:K;
    [|discriminate]. clear H.
  destruct (check_pieces_ok w m _ _ _ K k p Np) as (nodes' & left' & B).
  apply (check_bodies_ok w WF m p _ _ (bodies w) ltac:(eexists; reflexivity) 0 [] nodes' left' B j b i a t Nb); [|exact C | | exact HI].
  - right. exists i. split; [exact Hij|]. split; [exact Na | reflexivity].
  - destruct Ht as [H0 H1]. split; [exact H0|]. eapply Rle_trans; [exact H1|]. unfold ends.
    destruct (Nat.eqb (S k) (length (pieces m))); [apply number_up_ok | rewrite V_one; lra].
Qed.
